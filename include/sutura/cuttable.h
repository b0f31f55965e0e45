// What scissors ask of a thread.
#pragma once

#include <string>

#include "sutura/types.h"

namespace sutura {

class Cuttable {
 public:
  static constexpr const char* interface_name = "Cuttable";
  virtual ~Cuttable() = default;
  /// At abscissa s (m), for good. Between two steps.
  virtual void cut(Real s) = 0;
  /// Why it cannot be cut, in a sentence, or empty. Known after `initialise`.
  virtual std::string uncuttable() const = 0;
};

}  // namespace sutura
