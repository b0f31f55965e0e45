// A scene of tools on a rod that obeys exactly.
#pragma once

#include <gtest/gtest.h>

#include "grasper.h"
#include "text_world.h"
#include "track.h"
#include "unit/tools/fake_curve.h"

namespace sutura::tools {

struct Loaded : test::TextWorld {
  explicit Loaded(const std::string& elements, const std::filesystem::path& folder = ".") {
    registry.component<Track>("Track");
    registry.component<Grasper>("Grasper");
    registry.component<fake::Curve>("Curve");
    load("dt='0.1 s'", elements, folder);
  }
  template <class V>
  V output(const char* path, const std::string& name) const {
    std::string error;
    const OutputHandle handle = simulation->scene().output(std::string(path) + "." + name, error);
    if (!handle) throw std::runtime_error(error);
    return std::get<V>(handle.read());
  }
  /// The error of setting an input, or of looking it up.
  std::string set(const std::string& name, const InputValue& value) const {
    std::string error;
    const InputHandle handle = simulation->scene().input(name, error);
    return handle ? handle.set(value) : error;
  }
};

/// One that has to load, or the test fails with what was said.
struct Running : Loaded {
  explicit Running(const std::string& elements, const std::filesystem::path& folder = ".")
      : Loaded(elements, folder) {
    if (!simulation) throw std::runtime_error(messages());
  }
  void step(int count = 1) const {
    for (int i = 0; i < count; ++i) simulation->step();
  }
  const fake::Curve& rod() const { return get<fake::Curve>("/rod"); }
  /// A point of the rod, and its direction.
  Vec3 point(Real s) const { return rod().point(s, Configuration::current); }
  Vec3 along() const { return rod().tangent(0, Configuration::current); }
};

inline constexpr Real rounding = 1e-14;  // of metres, over a few dozen steps

}  // namespace sutura::tools
