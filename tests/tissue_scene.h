// A scene of one tissue from a few lines of XML, run in-process with the plugin enrolled
// statically.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "attach.h"
#include "layer.h"
#include "solver_components.h"
#include "sutura/simulation.h"
#include "tet_mesh.h"
#include "tissue.h"

namespace sutura::test {

using namespace tissue;

inline std::string all_messages(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics.all()) text += d.text() + "\n";
  return text;
}

class TissueScene {
 public:
  explicit TissueScene(const std::string& components, const std::string& gravity = "0 0 -9.81",
                       const std::string& dt = "10 ms", void (*enrol_more)(Registry&) = nullptr,
                       const StepLimits& limits = {}) {
    registry_.begin_plugin("tissue");
    registry_.component<TetMesh>("TetMesh");
    registry_.component<Tissue>("Tissue");
    registry_.component<Layer>("Layer");
    registry_.component<Attach>("Attach");
    enrol_tissue_solvers(registry_);
    if (enrol_more) enrol_more(registry_);
    registry_.end_plugin();
    enrol_builtin(registry_);
    auto scene = load_scene_text("<sutura version='1' dt='" + dt + "' gravity='" + gravity +
                                     "'>\n<plugin name='tissue'/>\n" + components + "\n</sutura>",
                                 "scene.xml", SUTURA_SOURCE_DIR, registry_, diagnostics);
    if (scene) scene->limits = limits;
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
  }
  Simulation& simulation() { return *simulation_; }
  const StepReport& step() { return simulation_->step(); }
  Tissue& tissue() {
    for (Component* c : simulation_->scene().components())
      if (auto* t = dynamic_cast<Tissue*>(c)) return *t;
    throw std::logic_error("no tissue in the scene");
  }
  /// `path` of the component: the tag in small letters where it has no name.
  OutputValue output(const std::string& path, const std::string& name) {
    const Component* c = simulation_->find(path);
    EXPECT_NE(c, nullptr) << path;
    for (const OutputInfo& o : c->info().outputs)
      if (o.name == name) return o.read(*c);
    ADD_FAILURE() << "no output " << name;
    return Real{0};
  }

  Diagnostics diagnostics;

 private:
  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace sutura::test
