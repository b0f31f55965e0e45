// A scene of tools on a rod that obeys exactly.
#pragma once

#include <gtest/gtest.h>

#include "grasper.h"
#include "track.h"
#include "unit/tools/fake_curve.h"

namespace sutura::tools {

struct Loaded {
  Diagnostics diagnostics;
  Registry registry;
  std::unique_ptr<Simulation> simulation;

  explicit Loaded(const std::string& elements, const std::filesystem::path& folder = ".") {
    registry.component<Track>("Track");
    registry.component<Grasper>("Grasper");
    registry.component<fake::Curve>("Curve");
    auto scene = load_scene_text("<sutura version=\"1\" dt=\"0.1 s\">" + elements + "</sutura>",
                                 "test.xml", folder, registry, diagnostics);
    if (scene) simulation = Simulation::compile(std::move(scene), ".", diagnostics);
  }
  std::string messages() const {
    std::string out;
    for (const Diagnostic& d : diagnostics.all()) out += d.text() + "\n";
    return out;
  }
  template <class T>
  T& get(const char* path) const {
    return dynamic_cast<T&>(*simulation->find(path));
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

}  // namespace sutura::tools
