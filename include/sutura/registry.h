// The list of what a scene may contain: an object, passed explicitly. No static constructors.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sutura/describe.h"
#include "sutura/law.h"

namespace sutura {

class Registry {
 public:
  /// T derives from Component and has `static void describe(Describe<T>&)`.
  template <class T>
  void component(const std::string& name) {
    ComponentInfo& info = add_component(name);
    Describe<T> d(info);
    T::describe(d);
    info.create = [] { return std::make_unique<T>(); };
  }

  /// L satisfies the Law concept of law.h.
  template <Law L>
  void law() {
    add_law(&law_operations<L>);
  }

  /// A plugin that uses devices tells which ones this machine has: lines of text.
  void devices(std::function<std::string()> list) { devices_.push_back(std::move(list)); }
  const std::vector<std::function<std::string()>>& devices() const { return devices_; }

  const ComponentInfo* find(const std::string& name) const;
  std::vector<const ComponentInfo*> components() const;  ///< sorted by plugin, then name
  const std::vector<const LawOperations*>& laws() const { return laws_; }

  /// Names enrolled from now on belong to this plugin.
  void begin_plugin(std::string name) { plugin_ = std::move(name); }
  bool has_plugin(const std::string& name) const;
  void end_plugin();
  /// Names that were enrolled although they existed; the first one holds. Each is a sentence.
  const std::vector<std::string>& clashes() const { return clashes_; }

 private:
  ComponentInfo& add_component(const std::string& name);
  void add_law(const LawOperations* law);
  void check_names(const ComponentInfo& info);

  std::map<std::string, std::unique_ptr<ComponentInfo>> components_;
  std::vector<const LawOperations*> laws_;
  std::vector<std::unique_ptr<ComponentInfo>> refused_;
  std::vector<std::function<std::string()>> devices_;
  std::vector<std::string> clashes_;
  std::vector<std::string> plugins_;
  std::string plugin_ = "core";
};

/// The components that need no plugin (solvers).
void enrol_builtin(Registry& registry);

}  // namespace sutura
