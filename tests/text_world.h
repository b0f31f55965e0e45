// A scene from text, compiled. Tests enrol what they need, then load.
#pragma once

#include <memory>
#include <string>

#include "sutura/plugin.h"
#include "sutura/simulation.h"

namespace sutura::test {

struct TextWorld {
  Diagnostics diagnostics;
  Registry registry;
  std::unique_ptr<Simulation> simulation;  ///< none if there is an error

  /// `attributes` are those of <sutura>, `elements` what is in it.
  void load(const std::string& attributes, const std::string& elements,
            const std::filesystem::path& folder = ".") {
    auto scene = load_scene_text("<sutura version='1' " + attributes + ">" + elements + "</sutura>",
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
};

}  // namespace sutura::test
