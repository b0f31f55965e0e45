// Loads a scene from a file or from text, runs it in-process and reads outputs by name.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "sutura/describe.h"
#include "sutura/simulation.h"

namespace sutura::testing {

/// "<sutura ...>" with the plugins named, around `content`.
inline std::string scene_of(const std::string& content, const std::string& settings) {
  std::string text = "<sutura version=\"1\" " + settings + ">\n";
  for (const char* plugin : {"thread", "tissue", "suturing", "tools", "output"})
    text += "<plugin name=\"" + std::string(plugin) + "\"/>\n";
  return text + content + "\n</sutura>\n";
}

class TextRun {
 public:
  explicit TextRun(const std::string& content,
                   const std::string& settings = "dt=\"10 ms\" gravity=\"0 0 0\"") {
    enrol_builtin(registry_);
    const LoadOptions options{.plugin_directories = {SUTURA_BINARY_DIR "/lib/sutura"}};
    compile(load_scene_text(scene_of(content, settings), "scene.xml",
                            SUTURA_SOURCE_DIR "/scenes/suture", registry_, diagnostics_, options));
  }
  /// A file below scenes/.
  static TextRun file(const std::string& name,
                      std::vector<std::pair<std::string, std::string>> overrides = {}) {
    TextRun run;
    const LoadOptions options{.plugin_directories = {SUTURA_BINARY_DIR "/lib/sutura"},
                              .overrides = std::move(overrides)};
    run.compile(
        load_scene(SUTURA_SOURCE_DIR "/scenes/" + name, run.registry_, run.diagnostics_, options));
    EXPECT_TRUE(run.diagnostics_.ok()) << run.said();
    return run;
  }
  TextRun(TextRun&&) = default;

  explicit operator bool() const { return simulation_ != nullptr; }
  Simulation& simulation() { return *simulation_; }
  /// All messages, one per line.
  std::string said() const {
    std::string out;
    for (const Diagnostic& d : diagnostics_.all()) out += d.text() + '\n';
    return out;
  }
  void run(Real seconds) {
    while (simulation_->time() < seconds - 1e-9) simulation_->step();
  }
  OutputValue output(const std::string& path, const std::string& name) const {
    const Component* c = simulation_->find(path);
    if (c == nullptr) {
      ADD_FAILURE() << "no component " << path;
      return Real(0);
    }
    for (const OutputInfo& o : c->info().outputs)
      if (o.name == name) return o.read(*c);
    ADD_FAILURE() << path << " has no output " << name;
    return Real(0);
  }
  Real number(const std::string& path, const std::string& name) const {
    return std::get<Real>(output(path, name));
  }
  Vec3 vector(const std::string& path, const std::string& name) const {
    return std::get<Vec3>(output(path, name));
  }
  template <class T>
  T& component(const std::string& path) {
    return dynamic_cast<T&>(*simulation_->find(path));
  }

 private:
  TextRun() { enrol_builtin(registry_); }
  void compile(std::unique_ptr<Scene> scene) {
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics_);
  }

  Registry registry_;  // before what is made from it: it must live longer
  Diagnostics diagnostics_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace sutura::testing
