// The only writer of what a component knows about itself, and of the private parts of a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sutura/scene.h"

namespace sutura {

class SceneBuilder {
 public:
  /// A component with its default attributes.
  static std::unique_ptr<Component> create(const ComponentInfo& info, std::string name,
                                           std::string path, SourceLocation location) {
    std::unique_ptr<Component> component = info.create();
    component->name_ = std::move(name);
    component->path_ = std::move(path);
    component->location_ = std::move(location);
    component->info_ = &info;
    return component;
  }

  /// Adds `component` at the end of `node` and of the document order; its links are all empty.
  static Component& append(Scene& scene, Node& node, std::unique_ptr<Component> component) {
    node.components.push_back(std::move(component));
    Component& added = *node.components.back();
    scene.order_.push_back(&added);
    scene.links_[&added] = {};
    scene.slots_[&added].assign(added.info().links.size(), nullptr);
    return added;
  }

  /// The scene gives this attribute a value.
  static void note(Component& component, const std::string& attribute) {
    component.said_.push_back(attribute);
  }

  /// Sets the link of the given number in the description of `owner`. Set in ascending order.
  static void link(Scene& scene, Component& owner, std::size_t number, Component& target) {
    owner.info().links[number].assign(owner, target);
    scene.links_[&owner].push_back(&target);
    scene.slots_[&owner][number] = &target;
  }

  /// One entry per link of the description, nullptr where it is empty.
  static const std::vector<Component*>& slots(const Scene& scene, const Component& owner) {
    return scene.slots_.at(&owner);
  }
};

}  // namespace sutura
