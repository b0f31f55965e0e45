#include "sutura/component.h"

#include <utility>

namespace sutura {

Component::~Component() = default;

void Component::initialise(Setup&) {}
void Component::ready(Setup&) {}
void Component::archive(Archive&) {}

std::filesystem::path Setup::resolve(const std::string& file) const {
  return scene_directory / file;  // an absolute `file` replaces the directory
}

void Setup::error(const Component& who, std::string message, Category category) {
  diagnostics.error(who.location(), who.path(), std::move(message), category);
}

void Setup::warning(const Component& who, std::string message, Category category) {
  diagnostics.warning(who.location(), who.path(), std::move(message), category);
}

}  // namespace sutura
