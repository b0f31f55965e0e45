#include "sutura/scene.h"

namespace sutura {

std::vector<Component*> Scene::components() const {
  return order_;
}

Component* Scene::find(std::string_view path) const {
  for (Component* component : order_)
    if (component->path() == path) return component;
  return nullptr;
}

const std::vector<Component*>& Scene::links_of(const Component& owner) const {
  static const std::vector<Component*> none;
  const auto found = links_.find(&owner);
  return found == links_.end() ? none : found->second;
}

}  // namespace sutura
