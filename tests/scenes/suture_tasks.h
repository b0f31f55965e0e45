// The scenes of scenes/suture, by name.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace sutura::testing {

inline const std::filesystem::path suture_folder = SUTURA_SOURCE_DIR "/scenes/suture";

inline std::vector<std::string> suture_tasks() {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(suture_folder))
    if (entry.path().extension() == ".xml") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

inline std::filesystem::path suture_task(const std::string& name) {
  return suture_folder / (name + ".xml");
}

}  // namespace sutura::testing
