#include <string_view>

#include "../../plugins/suturing/puncture_law.h"
#include "step_checks.h"

namespace sutura::testing {

PunctureCount punctures(const ConstraintProblem& start, const ConstraintProblem& solved) {
  PunctureCount out;
  for (std::size_t i = 0; i < solved.blocks.size(); ++i) {
    const ConstraintBlock& b = solved.blocks[i];
    if (std::string_view(b.law->name) != suturing::PunctureLaw::name ||
        b.mode != suturing::PunctureLaw::penetrated ||
        start.blocks[i].mode == suturing::PunctureLaw::penetrated)
      continue;
    const auto& q = *static_cast<const suturing::PunctureLaw::Params*>(solved.block_params(b));
    if (!q.hold)
      ++out.exits;  // nothing in front of the tip is left to hold it
    else if ((q.normal + q.axis).norm() < 1e-9)
      ++out.layers;  // a layer has no surface but the needle's axis
    else
      ++out.entries;
  }
  return out;
}

}  // namespace sutura::testing
