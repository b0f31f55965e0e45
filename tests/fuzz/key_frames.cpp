// Any bytes are key frames or are refused with a reason; key frames that are read can be followed.
#include "key_frames.h"

#include <cstdio>
#include <cstdlib>

#include "key_frame_file.h"

using namespace sutura;
using namespace sutura::tools;

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  std::vector<FileProblem> problems;
  std::vector<KeyFrame> keys =
      parse_key_frames({reinterpret_cast<const char*>(data), size}, problems);
  if (keys.empty() == problems.empty()) {
    std::fprintf(stderr, "refused without a reason, or in spite of one\n");
    std::abort();
  }
  if (keys.empty() || !KeyFrames::check(keys).empty()) return 0;
  const Real begin = keys.front().time, end = keys.back().time;
  const KeyFrames frames(std::move(keys), Vec3::Zero(), Easing::smooth);
  frames.at(begin);
  frames.at((begin + end) / 2);
  frames.at(end);
  return 0;
}
