// A program of one's own around a simulation: it loads a scene, moves a tool, reads results.
#include <cstdio>

#include "sutura/simulation.h"
#include "sutura/tool.h"

using namespace sutura;

int main(int argc, char** argv) {
  if (argc != 2) return 1;

  // The registry holds the components of the plugins that the scene names; it outlives the scene.
  Registry registry;
  enrol_builtin(registry);
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene = load_scene(argv[1], registry, diagnostics);
  std::unique_ptr<Simulation> simulation;
  if (scene) simulation = Simulation::compile(std::move(scene), "out/host", diagnostics);
  for (const Diagnostic& d : diagnostics.all()) std::fprintf(stderr, "%s\n", d.text().c_str());
  if (!simulation) return diagnostics.exit_code();

  // Components are found by path; what a host may do with them is in the public interfaces.
  auto* tool = dynamic_cast<Tool*>(simulation->find("/track"));
  auto* jaws = dynamic_cast<Jaws*>(simulation->find("/grasper"));
  if (tool == nullptr || jaws == nullptr) return 1;

  jaws->grasp();
  for (int i = 1; i <= 100; ++i) {
    // Where the hand of the user is; here, up by 10 mm in a second.
    tool->move_to({Vec3(0, 0, i * 0.1e-3), Quat::Identity()});
    const StepReport& report = simulation->step();
    if (report.failure || !report.finite) return 4;
    for (const std::string& message : report.messages) std::printf("%s\n", message.c_str());
  }

  // For drawing: points, cells and fields of every body.
  for (const Simulation::NamedBody& body : simulation->bodies()) {
    const BodyGeometry geometry = body.body->geometry();
    std::printf("%s: %zu points\n", body.path.c_str(), geometry.points.size());
  }
  // Outputs by name, as a probe reads them.
  const Component* grasper = simulation->find("/grasper");
  for (const OutputInfo& output : grasper->info().outputs)
    if (output.name == "force") {
      const Vec3 force = std::get<Vec3>(output.read(*grasper));
      std::printf("the jaws pull with %.3f mN\n", 1e3 * force.norm());
    }
}
