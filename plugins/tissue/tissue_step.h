// The motion of a tissue in a step: implicit Euler,
//   M (v - v_start) = h (f(x_start + h v) + M g - B v + p),   B = alpha M + beta K,
// f the force of elements, supports and loads, p of constraints. With A = M + h B + h^2 K, at a
// guess v,
//   A dv = r + h p,   r = M (v_start - v) + h (f(x) + M g - B v).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assembly.h"
#include "sutura/body.h"
#include "tissue_model.h"
#include "tissue_solver.h"

namespace sutura {
class Archive;
}

namespace sutura::tissue {

class TissueStep {
 public:
  /// The first three are kept by reference. `load`: of the step (N), empty or three numbers per
  /// node; followers change it at every guess. `pattern`: of the pairs of the elements.
  TissueStep(TissueModel& model, TissueSolver& solver, VecX& load,
             std::shared_ptr<const NodePattern> pattern);

  /// Makes the factor that the first step needs: the first step finds the same matrix again.
  void prepare(Real dt);

  // The stages of a step, as in Body.
  void begin(const StepContext& context);
  void linearise(const StepContext& context, const VecX& force);
  const VecX& change() const { return change_; }
  void push(const StepContext& context, const VecX& force_change);
  void correct(const StepContext& context);
  void move_to(const StepContext& context, const VecX& motion);
  Imbalance imbalance(const StepContext& context, const VecX& force);
  Real time_error(const StepContext& context) const;
  void end(const StepContext& context, const VecX& force);

  const VecX& start_positions() const { return start_x_; }
  const VecX& positions() const { return x_; }   ///< during a step: at the guess of its end
  const VecX& velocities() const { return v_; }  ///< likewise
  /// Force with which nodes are held, over the last step: what is missing in the balance of fixed
  /// ones, and the springs of supports (N).
  const VecX& reaction() const { return reaction_; }
  Index linearisations() const { return linearisations_; }  ///< in the last step
  bool finite() const;
  /// What went wrong in the last step, as clauses; empty if nothing did.
  std::string trouble() const;

  /// Between steps. Fixed nodes are fixed where they are put; their velocity becomes zero.
  void set_state(const VecX& x, const VecX& v);
  /// The reaction is that of a balance under weight and load.
  void rest(const Vec3& gravity);
  /// The factor in use is of another shape: the next step makes a new one.
  void renew() { assembled_for_ = 0; }
  void archive(Archive& archive);

 private:
  void assemble(Real dt, Index step);
  void evaluate_force();
  void add_outer_forces();
  void balance(const StepContext& context);
  void solve_what_matters(const StepContext& context, VecX& momentum);
  Real size_of_free(const VecX& momentum) const;
  Real moved_since_linearised() const;
  Real rounding_of(Real dt) const;

  TissueModel& model_;
  TissueSolver& solver_;
  VecX& load_;

  VecX x_, v_;  ///< the state; during a step, the guess of its end
  bool in_step_ = false;
  VecX start_x_, start_v_;

  // What is known at the guess.
  VecX force_;        ///< elastic, of supports and of loads (N)
  VecX missing_;      ///< momentum due there, without constraint forces and reactions (N s)
  VecX change_;       ///< of the velocity, that answers it and `push` (m/s)
  Real at_work_ = 0;  ///< size of the forces there, when last measured (N)

  Assembly assembly_;
  NodeMatrix A_;
  VecX linearised_at_;            ///< positions at which A was made
  bool solver_is_ready_ = false;  ///< for this step
  bool is_restored_ = false;      ///< A, whose rotations have to be found again
  VecX pushed_;                   ///< by constraints, in this pass (N s)
  Real asked_ = 0;                ///< of A by this pass (N s)
  Real may_stay_ = 0;             ///< what the solver may leave of that (N s)
  bool outdated_ = false;         ///< A has not answered well since it was made
  Real assembled_for_ = 0;        ///< and the length of the step (s)
  Index linearisations_ = 0;      ///< in this step
  std::string solver_trouble_;    ///< in all of them but the last, which the solver still knows
  VecX reaction_;

  VecX answer_;  ///< memory of `correct`
  std::vector<Mat3> node_rotations_;
};

}  // namespace sutura::tissue
