#include "sutura/component.h"

namespace sutura {

Component::~Component() = default;

void Component::initialise(Setup&) {}

}  // namespace sutura
