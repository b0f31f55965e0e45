// What a component has to say of a whole run.
#pragma once

#include <string>

namespace sutura {

class EndNote {
 public:
  static constexpr const char* interface_name = "EndNote";
  virtual ~EndNote() = default;
  /// What was asked of it and never came about, as a cut of scissors that close on nothing: a
  /// sentence; empty if there is nothing to say. Asked when a run is done.
  virtual std::string end_note() const = 0;
};

}  // namespace sutura
