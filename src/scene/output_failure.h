// What an output has thrown when somebody else read it.
#pragma once

#include <stdexcept>
#include <string>

#include "sutura/component.h"

namespace sutura {

class OutputFailure : public std::runtime_error {
 public:
  OutputFailure(const Component& component, const std::string& output, const std::string& what)
      : std::runtime_error("output '" + output + "': " + what), who(&component) {}
  const Component* who;
};

}  // namespace sutura
