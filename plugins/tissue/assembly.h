// Forces of the elements, the matrix of a step and the rotations of the nodes: made on the device
// of the solver if it has one that knows the elements, else here.
#pragma once

#include <vector>

#include "block_matrix.h"
#include "tissue_model.h"
#include "tissue_solver.h"

namespace sutura::tissue {

class Assembly final : public MatrixSource {
 public:
  /// Both are kept by reference.
  Assembly(TissueModel& model, TissueSolver& solver)
      : model_(model), solver_(solver), start_(model.rest) {}

  /// For a step of length h from these positions, until the next call.
  void begin(const VecX& start, Real h);
  /// A <- (1 + h alpha) M + h^2 (K of supports and loads) + (h^2 + h beta) (K of elements) at x;
  /// force <- that of the elements (N). Rotations are found if the solver wants them.
  void linearise(const VecX& x, Real h, NodeMatrix& A, VecX& force, std::vector<Mat3>& rotations);
  /// force <- that of the elements (N).
  void find_force(const VecX& x, const NodePattern& pattern, VecX& force);
  /// A has been restored, as it was made at x: brings it to where it was made, and finds the
  /// rotations there again, so that the run goes on with the same bits.
  void restore(const VecX& x, Real h, NodeMatrix& A, std::vector<Mat3>& rotations);
  /// Of the matrix that was assembled last.
  void bring(NodeMatrix& A) override;

 private:
  /// Null where the device of the solver cannot do it.
  ConjugateGradientDevice* device_for(const NodePattern& pattern);
  const VecX& moved(const VecX& x);
  void begin_here();
  void linearise_here(const VecX& x, Real h, NodeMatrix& A, VecX& force);

  TissueModel& model_;
  TissueSolver& solver_;
  Index revision_ = -1;                          ///< of the elements that the device has
  VecX start_;                                   ///< where the step begins
  Real share_ = 0;                               ///< beta / (h + beta)
  bool begun_here_ = true, begun_there_ = true;  ///< before the first step nothing flows
  VecX moved_, diagonal_, unused_;
  VecX assembled_at_;       ///< the positions of the matrix that was left on the device
  Real assembled_for_ = 0;  ///< and the length of its step (s)
};

}  // namespace sutura::tissue
