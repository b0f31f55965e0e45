// The tree of a scene: nodes, components, settings. For people; `compile` makes arrays of it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sutura/component.h"
#include "sutura/diagnostics.h"
#include "sutura/registry.h"

namespace sutura {

class Node {
 public:
  std::string name;  ///< empty for the root
  std::string path;  ///< "/" for the root, "/skin" below it
  SourceLocation location;
  Node* parent = nullptr;
  std::vector<std::unique_ptr<Component>> components;
  std::vector<std::unique_ptr<Node>> children;
};

struct PluginUse {
  std::string name;
  SourceLocation location;
};

/// When a step counts as solved (docs/step.md).
struct StepLimits {
  Real tolerance = 1e-2;      ///< of the imbalance of every body, relative to the forces at work
  Real gap_tolerance = 1e-6;  ///< of the distance of every constraint from its law, m
  Real time_tolerance = 0;    ///< of what its length costs it (BodyReport::time_error), m; 0: any
  Index passes = 20;          ///< before a step is divided
  Index time_order = 1;       ///< 2: of threads, in steps without rows
  Index substeps = 16;        ///< into which a step may be divided, a power of 2; 1: never
};

class Scene {
 public:
  std::filesystem::path file;  ///< its folder resolves relative files, also for a scene from memory
  Real dt = 0.01;              ///< s
  Vec3 gravity{0, 0, -9.81};   ///< m/s^2
  Real duration = 0;           ///< s; what `sutura run` simulates when it is not told; 0: not given
  StepLimits limits;           ///< how well a step must balance, and what it may take
  std::vector<PluginUse> plugins;
  Node root;

  /// All components, in document order.
  std::vector<Component*> components() const;
  /// By path ("/skin/tissue"), or nullptr.
  Component* find(std::string_view path) const;
  /// An output or input by the path of its component, a dot and its name ("/holder.force"). Empty,
  /// and a sentence in `error` that names what is there, if there is none.
  OutputHandle output(std::string_view name, std::string& error) const;
  InputHandle input(std::string_view name, std::string& error) const;
  /// The components that `owner` links to, in the order of its links.
  const std::vector<Component*>& links_of(const Component& owner) const;

 private:
  friend class SceneBuilder;
  std::vector<Component*> order_;  // document order
  std::map<const Component*, std::vector<Component*>> links_;
  std::map<const Component*, std::vector<Component*>> slots_;  // one per LinkInfo, or nullptr
};

struct LoadOptions {
  std::vector<std::string> plugin_directories = {};  ///< searched before the default ones
  /// ("/skin/tissue.young", "30 kPa"), (".dt", "5 ms"): replaces or adds the attribute.
  std::vector<std::pair<std::string, std::string>> overrides = {};
};

/// Nothing if there is any error; all errors are in `diagnostics`.
std::unique_ptr<Scene> load_scene(const std::filesystem::path& file, Registry& registry,
                                  Diagnostics& diagnostics, const LoadOptions& options = {});
/// From text; `directory` resolves relative files, `name` stands for the file in messages.
std::unique_ptr<Scene> load_scene_text(std::string_view text, const std::string& name,
                                       const std::filesystem::path& directory, Registry& registry,
                                       Diagnostics& diagnostics, const LoadOptions& options = {});
/// XML that loads to the same scene: every attribute that the scene gave or that differs from its
/// default, every link.
std::string write_scene(const Scene& scene);

}  // namespace sutura
