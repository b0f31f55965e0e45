// A component: what an XML element becomes. It owns attributes (input), state that `archive`
// declares, and caches that can be made again from the two.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sutura/diagnostics.h"
#include "sutura/types.h"

namespace sutura {

struct ComponentInfo;
class Archive;
class Cache;
class Component;
class Scene;
class WorkerPool;

/// What a host gives to its simulations; null: nothing.
struct Resources {
  std::shared_ptr<WorkerPool> pool;  ///< who works beside the steps, instead of own workers
  std::shared_ptr<Cache> cache;      ///< for what several simulations have in common
};

/// Handed to Component::initialise: the settings of the scene and a place to complain.
struct Setup {
  Diagnostics& diagnostics;
  std::filesystem::path scene_directory;   ///< relative files are resolved against it
  std::filesystem::path output_directory;  ///< where recorders write
  Real dt = 0.01;                          ///< s
  Vec3 gravity = Vec3::Zero();             ///< m/s^2
  Index source_id = 0;                     ///< unique per component, for constraint keys
  const Scene* scene = nullptr;            ///< for components that name others in a text (probes)
  bool allow_outside = false;              ///< files outside of the folders of scene and results
  std::size_t errors_before = 0;           ///< in `diagnostics`, when this component began

  /// What is written: names in the output folder. A folder's files are its `pattern`.
  struct Claim {
    std::string owner;
    std::string pattern;
  };
  std::map<std::string, Claim> claims = {};
  Resources resources = {};

  /// False once this component has complained. Errors of others are none of its business.
  bool ok() const { return diagnostics.errors() == errors_before; }

  std::filesystem::path resolve(const std::string& file) const;
  /// A note if the file lies neither in the folder of the scene nor in one beside it.
  void note_if_outside(const Component& who, const std::string& file);
  /// "; did you mean 'meshes/pad.msh'?" for a file that does not exist, or nothing.
  std::string did_you_mean_file(const std::string& file) const;
  /// Where `who` may write the file that its `attribute` names. Nothing after an error: the name is
  /// empty, leads out of the output folder, or is another component's. With a pattern ("*.vtu") the
  /// name is a folder.
  std::optional<std::filesystem::path> output(const Component& who, const std::string& attribute,
                                              const std::string& name,
                                              const std::string& pattern = {});
  void error(const Component& who, std::string message, Category category = Category::scene);
  void warning(const Component& who, std::string message, Category category = Category::scene);
  /// Those of `attributes` that the scene gives mean nothing: "'size' has no effect: " and why.
  void warn_without_effect(const Component& who, std::initializer_list<const char*> attributes,
                           const std::string& why);
  /// Of keys at `times` (s, increasing), some are closer together than a step, which looks at one
  /// time only.
  void warn_of_hidden_keys(const Component& who, const std::vector<Real>& times);
  /// Of loads: what only acts before the first step ends.
  void warn_of_hidden_start(const Component& who, const std::vector<Real>& times);
};

class Component {
 public:
  Component() = default;
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  /// Called once by `compile`, after every component this one links to. Reads files and tells the
  /// components it links to what it wants of them. Errors go to `setup`; an exception is a
  /// programming error.
  virtual void initialise(Setup& setup);
  /// Called once by `compile` when every component has been initialised without an error, in the
  /// same order: now it is known what others want of this one. Makes everything that the first
  /// step would otherwise have to make.
  virtual void ready(Setup& setup);
  /// What has to be remembered from one step to the next, said once for saving and for restoring
  /// (archive.h). A component that remembers nothing leaves it out.
  virtual void archive(Archive& archive);

  const std::string& name() const { return name_; }
  const std::string& path() const { return path_; }  ///< "/skin/tissue"
  const SourceLocation& location() const { return location_; }
  const ComponentInfo& info() const { return *info_; }
  /// Whether the scene says this attribute itself: what it says wins over what is looked up.
  bool says(std::string_view attribute) const;

 private:
  friend class SceneBuilder;
  std::string name_;
  std::string path_;
  SourceLocation location_;
  const ComponentInfo* info_ = nullptr;
  std::vector<std::string> said_;  ///< names of the attributes in the scene
};

/// A reference to another component, by interface. Written as a path in XML; left out, it means
/// the only component of that type in reach. Resolved before initialise.
template <class T>
class Link {
 public:
  T* operator->() const { return target_; }
  T& operator*() const { return *target_; }
  T* get() const { return target_; }
  explicit operator bool() const { return target_ != nullptr; }
  void set(T* target) { target_ = target; }

 private:
  T* target_ = nullptr;
};

}  // namespace sutura
