#include "sutura/component.h"

#include <algorithm>

namespace sutura {

Component::~Component() = default;

void Component::initialise(Setup&) {}
void Component::ready(Setup&) {}
void Component::archive(Archive&) {}

bool Component::says(std::string_view attribute) const {
  return std::find(said_.begin(), said_.end(), attribute) != said_.end();
}

}  // namespace sutura
