// Coulomb: contact with dry friction. Rows: normal, tangent 1, tangent 2.
//
//   0 <= delta_n + c lambda_n  _|_  lambda_n >= 0
//   |lambda_t| <= mu lambda_n;  if delta_t != 0:  lambda_t = -mu lambda_n delta_t / |delta_t|
//
// delta_n (m) gap, delta_t (m) slip over the step, lambda (N), c (m/N) compliance of the contact
// along its normal. The slip opposes the tangential displacement itself (no dilatancy term, unlike
// associated friction).
//
// One block is solved exactly. Slip means delta_t = -k lambda_t with k >= 0 (m/N), so lambda(k) is
// the solution of a linear system and k a root of |lambda_t(k)| - mu lambda_n(k), which is positive
// at k = 0 (stick is not admissible) and negative for large k (only the normal force is left).
#pragma once

#include <limits>

#include "sutura/laws/ball.h"

namespace sutura {

enum class Friction : Mode { open, stick, slip, capped_stick, capped_slip };

/// One contact with friction and a normal force of at most `cap`: beyond, delta_n <= 0 yields.
Friction solve_friction(const Mat3& W, const Vec3& d, Real mu, Real cap, Vec3& lambda);

/// The state that a force on the friction law's graph belongs to. Projection puts limits exactly; a
/// force that was rotated since then is still taken for one at its limit.
Friction friction_state(const Vec3& lambda, Real mu, Real cap);

/// Tangent of the friction law at (delta, lambda); compliance along the normal.
void friction_directions(const Vec3& delta, Real mu, Real compliance, Friction state,
                         const Vec3& lambda, FreeDirections<3>& free);

struct Coulomb {
  static constexpr int dim = 3;
  static constexpr const char* name = "coulomb";
  struct Params {
    Real mu = 0;          ///< friction coefficient
    Real compliance = 0;  ///< c, m/N
  };

  static void project(const Mat3& W, const Vec3& d, const Params& p, Mode& mode, Vec3& lambda) {
    Mat3 total = W;
    total(0, 0) += p.compliance;
    mode = static_cast<Mode>(
        solve_friction(total, d, p.mu, std::numeric_limits<Real>::infinity(), lambda));
  }
  static void free_directions(const Vec3& delta, const Params& p, Mode mode, const Vec3& lambda,
                              FreeDirections<3>& free) {
    friction_directions(delta, p.mu, p.compliance, static_cast<Friction>(mode), lambda, free);
  }
};

}  // namespace sutura
