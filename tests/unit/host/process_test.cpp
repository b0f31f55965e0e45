// What the host's process keeps: memory, floating-point mode, random numbers. And what results do
// not depend on.
#include <dlfcn.h>

#include <cfenv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "unit/host/loaded.h"

namespace sutura::host_tests {
namespace {

const std::string pricked = scenes + "suture/prick.xml";

/// Resident memory of this process (bytes).
double resident() {
  std::ifstream file("/proc/self/statm");
  double all = 0, here = 0;
  file >> all >> here;
  return here * 4096;
}

TEST(Process, MemoryIsFlatOverManySimulations) {
  const auto one = [] {
    const sutura_simulation s = load(scenes + "components/Grasper.xml");
    EXPECT_EQ(sutura_step(s, 2), SUTURA_OK) << sutura_error();
    EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
    const sutura_simulation t = load(scenes + "components/AsyncPreconditioner.xml");
    EXPECT_EQ(sutura_step(t, 2), SUTURA_OK) << sutura_error();
    EXPECT_EQ(sutura_destroy(t), SUTURA_OK);
  };
  int rounds = 60;
  if (const char* more = std::getenv("SUTURA_TEST_ROUNDS")) rounds = std::atoi(more);
  for (int i = 0; i < 10; ++i) one();
  const double before = resident();
  for (int i = 0; i < rounds; ++i) one();
  const double grown = resident() - before;
  // One of these simulations takes some 5 MB; the allocator may keep a few pages more or less.
  EXPECT_LT(grown, 4e6) << "after " << rounds << " rounds";
  RecordProperty("grown_bytes", std::to_string(grown));
}

/// The state after some steps in the floating-point mode that the host has set.
std::vector<std::byte> in_mode(int rounding, bool flush) {
  std::fenv_t before;
  std::fegetenv(&before);
  std::fesetround(rounding);
#ifdef __SSE__
  const unsigned mode = __builtin_ia32_stmxcsr();
  if (flush) __builtin_ia32_ldmxcsr(mode | 0x8040);  // flush to zero, denormals are zero
#endif
  std::feraiseexcept(FE_DIVBYZERO);
  std::fenv_t expected, found;
  std::fegetenv(&expected);
  std::vector<std::byte> out = state_after(pricked, 15);
  std::fegetenv(&found);
  EXPECT_EQ(std::fegetround(), rounding);
  EXPECT_EQ(found.__mxcsr, expected.__mxcsr);
  EXPECT_NE(std::fetestexcept(FE_DIVBYZERO), 0);
  std::fesetenv(&before);
  return out;
}

TEST(Process, FloatingPointModeIsKeptAndDoesNotMatter) {
  const std::vector<std::byte> plain = state_after(pricked, 15);
  EXPECT_TRUE(in_mode(FE_UPWARD, false) == plain);
  EXPECT_TRUE(in_mode(FE_TOWARDZERO, true) == plain);
}

// A host that wants to be stopped by its own divisions by zero is not stopped by ours.
TEST(Process, TrapsOfTheHostAreNotSprung) {
  std::fenv_t before;
  std::fegetenv(&before);
  feenableexcept(FE_ALL_EXCEPT);
  const int trapped = fegetexcept();
  const sutura_simulation s = load(pricked);
  const sutura_status status = sutura_step(s, 5);
  const sutura_status end = sutura_destroy(s);
  const int after = fegetexcept();
  std::fesetenv(&before);
  EXPECT_EQ(status, SUTURA_OK);
  EXPECT_EQ(end, SUTURA_OK);
  EXPECT_EQ(after, trapped);
}

// The host has set it in this worker and sees its own mode while it is told something.
TEST(Process, MessagesComeInTheHostsMode) {
  sutura_options how = options();
  int found = -1;
  how.user = &found;
  how.message = [](void* user, std::int32_t, const char*) {
    *static_cast<int*>(user) = std::fegetround();
  };
  const std::string text = "<sutura version='1'><Nothing/></sutura>";
  sutura_simulation s = 0;
  std::fesetround(FE_DOWNWARD);
  EXPECT_EQ(sutura_load_text(text.data(), text.size(), nullptr, nullptr, &how, &s),
            SUTURA_BAD_SCENE);
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(found, FE_DOWNWARD);
}

/// Numbers of the threads of this process, and the signals that each of them blocks.
std::map<std::string, std::string> threads() {
  std::map<std::string, std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream status(entry.path() / "status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("SigBlk:")) out[entry.path().filename()] = line.substr(8);
  }
  return out;
}

TEST(Process, HandlersOfTheHostDoNotRunOnOurWorkers) {
  const std::string scene = scenes + "suture/first_stitch.xml";
  state_after(scene, 1);  // libraries start what they start
  const auto before = threads();
  const sutura_simulation s = load(scene);
  ASSERT_EQ(sutura_step(s, 50), SUTURA_OK) << sutura_error();
  int ours = 0;
  for (const auto& [number, blocked] : threads()) {
    if (before.contains(number)) continue;
    ++ours;
    EXPECT_EQ(blocked.substr(8), "7ffbfeff") << "SIGINT, SIGALRM, SIGTERM and the like";
  }
  EXPECT_GT(ours, 0) << "the scene does not show what this test is about";
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
}

// METIS, which orders the tissue, seeds and draws from the C library's random numbers.
TEST(Process, TheHostsRandomNumbersGoOn) {
  std::srand(7);
  const int first = std::rand(), second = std::rand();
  std::srand(7);
  EXPECT_EQ(std::rand(), first);
  state_after(scenes + "suture/prick.xml", 1);
  EXPECT_EQ(std::rand(), second);
}

TEST(Process, BlasKeepsItsWorkers) {
  state_after(pricked, 1);  // the plugin and what it links are in the process from now on
  void* const blas = dlopen("libopenblas.so.0", RTLD_NOW | RTLD_NOLOAD);
  if (blas == nullptr) GTEST_SKIP() << "this build has no OpenBLAS";
  const auto set = reinterpret_cast<void (*)(int)>(dlsym(blas, "openblas_set_num_threads"));
  const auto get = reinterpret_cast<int (*)()>(dlsym(blas, "openblas_get_num_threads"));
  ASSERT_TRUE(set != nullptr && get != nullptr);
  const int before = get();
  set(2);
  state_after(pricked, 5);
  EXPECT_EQ(get(), 2);
  set(before);
  dlclose(blas);
}

}  // namespace
}  // namespace sutura::host_tests
