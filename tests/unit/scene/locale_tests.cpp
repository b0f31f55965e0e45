// A host that sets a locale with decimal commas must not change how a scene is read or written.
#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <locale>

#include "unit/scene/toys.h"

#ifdef SUTURA_SANITIZED
// The path of locales that glibc was given last is never freed.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:argz_add_sep";
}
#endif

namespace sutura::toys {
namespace {

namespace fs = std::filesystem;

/// Sets a locale that writes 1.5 as "1,5" for C and C++ alike, compiling one if the system has
/// none.
class CommaLocale : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
      if (set(name)) return;
    folder_ = fs::temp_directory_path() / ("sutura_locale_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    const std::string command =
        "localedef -i de_DE -f UTF-8 '" + (folder_ / "de_DE.UTF-8").string() + "' >/dev/null 2>&1";
    const bool made = std::system(command.c_str()) == 0;
    ::setenv("LOCPATH", folder_.c_str(), 1);
    ASSERT_TRUE(made && set("de_DE.UTF-8"))
        << "no locale with decimal commas can be made (Debian: locales); ./dev test installs it";
  }
  void TearDown() override {
    std::setlocale(LC_ALL, "C");
    std::locale::global(std::locale::classic());
    ::unsetenv("LOCPATH");
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  static bool set(const char* name) {
    if (!std::setlocale(LC_ALL, name)) return false;
    try {
      std::locale::global(std::locale(name));
    } catch (const std::runtime_error&) {
      return false;
    }
    return true;
  }
  fs::path folder_;
};

TEST_F(CommaLocale, ChangesNothing) {
  char shown[16];
  std::snprintf(shown, sizeof shown, "%.1f", 1.5);
  ASSERT_STREQ(shown, "1,5");  // the locale is there indeed
  const auto l =
      load("<Ball radius='1.5 mm' count='1000' centre='0.5 -1.5e-1 2' weights='0.1 2,5'/>",
           {.overrides = {{".dt", "2.5 ms"}}});
  ASSERT_TRUE(l->scene) << l->text();
  EXPECT_EQ(l->get<Ball>("/ball").radius, 1.5e-3);
  EXPECT_EQ(l->get<Ball>("/ball").centre, Vec3(0.5, -0.15, 2));
  EXPECT_EQ(l->get<Ball>("/ball").weights, (std::vector<Real>{0.1, 2, 5}));
  EXPECT_EQ(l->scene->dt, 2.5e-3);
  const std::string text = write_scene(*l->scene);
  EXPECT_NE(text.find("radius=\"0.0015 m\""), std::string::npos) << text;
  EXPECT_NE(text.find("count=\"1000\""), std::string::npos) << text;
  const auto refused = load("<Ball radius='1,5'/>");
  EXPECT_FALSE(refused->scene);
  const auto range = load("<Ball stiffness='2.5 GPa'/>");
  EXPECT_NE(range->text().find("between 0 and 1e+09 Pa"), std::string::npos) << range->text();
}

}  // namespace
}  // namespace sutura::toys
