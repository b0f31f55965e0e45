// What scissors ask of a thread.
#pragma once

#include "sutura/types.h"

namespace sutura {

class Cuttable {
 public:
  static constexpr const char* interface_name = "Cuttable";
  virtual ~Cuttable() = default;
  /// At abscissa s (m), for good. Between two steps.
  virtual void cut(Real s) = 0;
};

}  // namespace sutura
