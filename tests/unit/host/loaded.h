// Scenes behind the C API, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "sutura/sutura.h"

namespace sutura::host_tests {

inline const std::string scenes = SUTURA_SOURCE_DIR "/scenes/";

/// A thread that a grasper holds, moved by a track; no plugin but these.
inline const std::string held_thread = R"(<sutura version="1" dt="5 ms">
  <plugin name="thread"/> <plugin name="tools"/>
  <SutureThread name="suture" thread="4-0 polypropylene" thread_length="50 mm"/>
  <Track times="0"/>
  <Grasper/>
</sutura>)";

inline sutura_options options() {
  sutura_options o{};
  o.struct_size = sizeof o;
  o.api = SUTURA_API;
  return o;
}

inline sutura_simulation load(const std::string& file, const sutura_options* how = nullptr) {
  sutura_simulation s = 0;
  EXPECT_EQ(sutura_load(file.c_str(), how, &s), SUTURA_OK) << sutura_error();
  return s;
}

inline sutura_simulation load_text(const std::string& text) {
  sutura_simulation s = 0;
  EXPECT_EQ(sutura_load_text(text.data(), text.size(), "test.xml", nullptr, nullptr, &s), SUTURA_OK)
      << sutura_error();
  return s;
}

inline std::vector<std::byte> state(sutura_simulation s) {
  const void* data = nullptr;
  std::size_t size = 0;
  EXPECT_EQ(sutura_save(s, &data, &size), SUTURA_OK) << sutura_error();
  const auto* bytes = static_cast<const std::byte*>(data);
  return {bytes, bytes + size};
}

/// Bits of a scene after some steps.
inline std::vector<std::byte> state_after(const std::string& file, std::size_t steps) {
  const sutura_simulation s = load(file);
  EXPECT_EQ(sutura_step(s, steps), SUTURA_OK) << sutura_error();
  const std::vector<std::byte> out = state(s);
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  return out;
}

/// Settings by which factors are adopted a fixed number of steps after their snapshot: those that
/// are adopted when they are ready depend on the clock.
inline std::vector<std::string> fixed_lags(const std::string& file) {
  std::vector<std::string> out;
  const sutura_simulation s = load(file);
  std::size_t count = 0;
  EXPECT_EQ(sutura_component_count(s, &count), SUTURA_OK);
  for (std::size_t i = 0; i < count; ++i) {
    sutura_component c{};
    c.struct_size = sizeof c;
    EXPECT_EQ(sutura_component_at(s, i, &c), SUTURA_OK);
    if (std::string(c.type) != "AsyncPreconditioner") continue;
    out.push_back(std::string(c.path) + ".lag");
    out.push_back("3");
  }
  EXPECT_EQ(sutura_destroy(s), SUTURA_OK);
  return out;
}

inline sutura_simulation load_fixed(const std::string& file, sutura_options how = options()) {
  const std::vector<std::string> settings = fixed_lags(file);
  std::vector<const char*> texts;
  for (const std::string& s : settings) texts.push_back(s.c_str());
  how.settings = texts.data();
  how.setting_count = texts.size() / 2;
  return load(file, &how);
}

}  // namespace sutura::host_tests
