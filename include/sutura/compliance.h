// The compliance of a body to its rows, W = h^2 H A^-1 H^T, in the two forms that the solver takes:
// a dense matrix that the body adds to, or, for a chain, what is needed to answer without ever
// forming that matrix.
#pragma once

#include <string>
#include <vector>

#include "sutura/types.h"

namespace sutura {

/// h^2 A^-1 of a chain of 6-dof nodes, between the nodes that rows touch. The inverse of a block
/// tridiagonal matrix is semiseparable: between touched nodes a < b the block is own[b] seen
/// through the transfers on the way,
///     h^2 A^-1(a, b) = transfer[a] transfer[a+1] ... transfer[b-1] own[b],
/// so t nodes need 2 t blocks and not t^2 / 2, however many untouched nodes lie between.
struct ChainCompliance {
  std::vector<Index>
      node;  ///< touched and free to move, ascending; rows on other nodes answer nothing
  std::vector<Mat6> own;       ///< h^2 A^-1(a, a), symmetric
  std::vector<Mat6> transfer;  ///< to the next touched node; that of the last one is zero

  Index size() const { return static_cast<Index>(node.size()); }
  bool empty() const { return node.empty(); }
  void clear() {
    node.clear();
    own.clear();
    transfer.clear();
  }
};

/// Who decides how the compliance of chains is kept.
enum class ComplianceForm {
  automatic,  ///< whatever is cheaper, counted
  assembled,  ///< in W
  as_operator
};

/// What the stage "compliance" did for one body, and why. Counts are multiplications expected for
/// this step, from the sweeps and direct solves of the step before; zero for a body that has no
/// operator form.
struct ComplianceReport {
  std::string body;  ///< path
  bool as_operator = false;
  Real assembled_count = 0;
  Real operator_count = 0;
};

}  // namespace sutura
