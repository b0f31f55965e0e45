// A component: what an XML element becomes. It owns attributes (input), state that `archive`
// declares, and caches that can be made again from the two.
#pragma once

#include <filesystem>
#include <string>
#include <type_traits>

#include "sutura/diagnostics.h"
#include "sutura/types.h"

namespace sutura {

struct ComponentInfo;
class Archive;
class Component;

/// Handed to Component::initialise: the settings of the scene and a place to complain.
struct Setup {
  Diagnostics& diagnostics;
  std::filesystem::path scene_directory;   ///< relative files are resolved against it
  std::filesystem::path output_directory;  ///< where recorders write
  Real dt = 0.01;                          ///< s
  Vec3 gravity = Vec3::Zero();             ///< m/s^2
  Index source_id = 0;                     ///< unique per component, for constraint keys

  std::filesystem::path resolve(const std::string& file) const;
  void error(const Component& who, std::string message, Category category = Category::scene);
  void warning(const Component& who, std::string message, Category category = Category::scene);
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

 private:
  friend class SceneBuilder;
  std::string name_;
  std::string path_;
  SourceLocation location_;
  const ComponentInfo* info_ = nullptr;
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
