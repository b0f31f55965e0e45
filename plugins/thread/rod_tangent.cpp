#include "rod_tangent.h"

#include <algorithm>

namespace sutura::thread {

namespace {

/// (1 - share) a + share b.
void blend(ElementMatrix& a, const ElementMatrix& b, Real share) {
  const auto mix = [share](Mat3& x, const Mat3& y) { x += share * (y - x); };
  mix(a.vv, b.vv), mix(a.va, b.va), mix(a.vb, b.vb);
  mix(a.aa, b.aa), mix(a.ab, b.ab), mix(a.bb, b.bb);
}

/// K of one beam, `convex` of it the convex one, with the share that viscosity adds to it: to be
/// multiplied by h (h + beta).
void stiffness(const Rod& rod, const RodStart& start, const RodGuess& guess, Index e, Real convex,
               ElementMatrix& k) {
  const ElementRest& rest = rod.element(e);
  const Real n = guess.tension[e], all = n + guess.limit_tension[e];
  const Real viscous = start.damping.stiffness / (start.dt + start.damping.stiffness);
  const Real exact = (1 - convex) * (1 - viscous);
  ElementState s = guess.beams[e];
  s.tension = all;
  if (exact < 1) {
    // All that is not the Hessian is linear in its tension: once, with their mean.
    const Real change = n - rest.axial * start.deformation[e].strain;  // times beta/h
    const Real sum = convex * (1 - viscous) * std::max(all, 0.) +
                     viscous * ((1 - convex) * change + convex * std::max(change, 0.));
    step_stiffness(rest, s, sum / (1 - exact), guess.chord_roll, k);
  }
  if (exact == 0) return;
  ElementMatrix h;
  hessian(rest, s, h);
  if (exact < 1) {
    blend(k, h, exact);
  } else {
    k = h;
  }
}

/// The derivative of the moments of constraint forces, which turn with the tangents; of all added
/// moments, `share`.
void add_turning_moments(const Rod& rod, const RodGuess& guess, Real dt, Real share,
                         BlockTridiagonal& matrix) {
  for (Index i = 0; i < rod.nodes(); ++i) {
    const Vec3 t = tangent(rod.poses()[i]);
    const Mat3 product = t * guess.force.lever_at(i, rod.poses()[i]).transpose();
    matrix.diagonal(rod.stretches().block(i)).bottomRightCorner<3, 3>() -=
        share * dt * dt / 2 * (product + product.transpose());
  }
}

/// The derivative of the moments that forces on followers have about their leaders: their arms
/// turn.
void add_turning_arms(const Rod& rod, const RodStart& start, const RodGuess& guess, Real share,
                      BlockTridiagonal& matrix) {
  const std::vector<Pose>& poses = rod.poses();
  const auto add = [&](Index node, const Vec3& force) {
    const Vec3 arm = rod.stretches().arm(poses, node);
    const Mat3 product = arm * force.transpose();
    matrix.diagonal(rod.stretches().block(node)).bottomRightCorner<3, 3>() +=
        share * start.dt * start.dt *
        (force.dot(arm) * Mat3::Identity() - (product + product.transpose()) / 2);
  };
  for (const RigidStretch& s : rod.stretches().all()) {
    for (Index i = s.first + 1; i <= s.last; ++i)
      add(i, start.load.segment<3>(6 * i) + guess.force.at.segment<3>(6 * i));
    if (s.last == rod.beams()) continue;
    ElementState beyond = guess.beams[s.last];
    beyond.tension = guess.tension[s.last];
    add(s.last, gradient(rod.element(s.last), beyond).v);
  }
  for (const NodeSpring& spring : rod.springs())
    if (spring.active) add(spring.node, guess.wrench(rod, spring).force);
}

/// What blocks on a node become on its leader: T^T A T, T the rigid motion of the node.
Mat6 rigid_motion(const Rod& rod, Index node) {
  Mat6 T = Mat6::Identity();
  if (rod.stretches().follows(node))
    T.topRightCorner<3, 3>() = -cross_matrix(rod.stretches().arm(rod.poses(), node));
  return T;
}

/// The blocks of a beam that ends at a follower.
struct BeamBlocks {
  Mat6 a, b, up;
  void add_to(const Rod& rod, Index e, BlockTridiagonal& matrix) const {
    const Mat6 Ta = rigid_motion(rod, e), Tb = rigid_motion(rod, e + 1);
    const Index to_a = rod.stretches().block(e), to_b = rod.stretches().block(e + 1);
    const Mat6 across = Ta.transpose() * up * Tb, own = Tb.transpose() * b * Tb;
    matrix.diagonal(to_a) += Ta.transpose() * a * Ta;
    if (to_a == to_b) {
      matrix.diagonal(to_a) += own + across + across.transpose();
    } else {
      matrix.diagonal(to_b) = own;
      matrix.upper(to_a) = across;
    }
  }
};

}  // namespace

void assemble(const Rod& rod, const RodStart& start, const RodGuess& guess, Tangent tangent,
              BlockTridiagonal& matrix) {
  assemble(rod, start, guess, tangent == Tangent::exact ? 0. : 1., matrix);
}

void assemble(const Rod& rod, const RodStart& start, const RodGuess& guess, Real convex,
              BlockTridiagonal& matrix) {
  const Real dt = start.dt;
  const Real mass_factor = 1 + dt * start.damping.mass;
  const Real stiffness_factor = dt * (dt + start.damping.stiffness);
  matrix.diagonal(0).setZero();
  const Mat3 zero = Mat3::Zero();
  ElementMatrix k;
  BeamBlocks alone;
  for (Index e = 0; e < rod.beams(); ++e) {
    const Stretches& stretches = rod.stretches();
    if (stretches.is_rigid(e)) {
      k = {zero, zero, zero, zero, zero, zero};
    } else {
      stiffness(rod, start, guess, e, convex, k);
    }
    const bool at_follower = stretches.follows(e) || stretches.follows(e + 1);
    const ElementMass& m = rod.inertia(e);
    const ElementState& s = guess.beams[e];

    const Index block = stretches.block(e);
    Mat6& da = at_follower ? alone.a : matrix.diagonal(block);
    Mat6& db = at_follower ? alone.b : matrix.diagonal(block + 1);
    Mat6& up = at_follower ? alone.up : matrix.upper(block);
    if (at_follower) da.setZero();
    const Mat3 ee = s.e * s.e.transpose();
    const Mat3 vv = stiffness_factor * k.vv;
    const Real same = mass_factor * m.same, other = mass_factor * m.other;
    const Real cs = mass_factor * m.couple_same, co = mass_factor * m.couple_other;
    const Real ss = mass_factor * m.spin_same, so = mass_factor * m.spin_other;
    const Real rs = mass_factor * m.roll_same, ro = mass_factor * m.roll_other;
    const Mat3 ta = cross_matrix(s.ta), tb = cross_matrix(s.tb);

    da.topLeftCorner<3, 3>() += plus_diagonal(vv, same);
    const Mat3 xs = stiffness_factor * k.va + cs * ta;
    da.topRightCorner<3, 3>() -= xs;
    da.bottomLeftCorner<3, 3>() -= xs.transpose();
    da.bottomRightCorner<3, 3>() +=
        plus_diagonal(stiffness_factor * k.aa + rs * ee - ss * (s.ta * s.ta.transpose()), ss + rs);

    db.topLeftCorner<3, 3>() = plus_diagonal(vv, same);
    const Mat3 ys = stiffness_factor * k.vb + cs * tb;
    db.topRightCorner<3, 3>() = ys;
    db.bottomLeftCorner<3, 3>() = ys.transpose();
    db.bottomRightCorner<3, 3>() =
        plus_diagonal(stiffness_factor * k.bb + rs * ee - ss * (s.tb * s.tb.transpose()), ss + rs);

    up.topLeftCorner<3, 3>() = plus_diagonal(-vv, other);
    up.topRightCorner<3, 3>() = -stiffness_factor * k.vb - co * tb;
    up.bottomLeftCorner<3, 3>() = (stiffness_factor * k.va + co * ta).transpose();
    up.bottomRightCorner<3, 3>() =
        plus_diagonal(stiffness_factor * k.ab + ro * ee - so * (s.tb * s.ta.transpose()),
                      so * s.ta.dot(s.tb) + ro);
    if (at_follower) alone.add_to(rod, e, matrix);
  }
  if (convex < 1) {
    add_turning_moments(rod, guess, dt, 1 - convex, matrix);
    add_turning_arms(rod, start, guess, 1 - convex, matrix);
  }
  for (const NodeSpring& spring : rod.springs()) {
    if (!spring.active) continue;
    Vec6 own;
    own << Vec3::Constant(dt * dt * spring.stiffness.translation),
        Vec3::Constant(dt * dt * spring.stiffness.rotation);
    const Mat6 T = rigid_motion(rod, spring.node);
    matrix.diagonal(rod.stretches().block(spring.node)) += T.transpose() * own.asDiagonal() * T;
  }
  for (const Index node : rod.clamped())
    for (int d = 0; d < 6; ++d) matrix.fix(rod.stretches().block(node), d);
}

// Rounding can cost a stiff, slender chain its positive definiteness (a free thread's inertia about
// its own axis is 1e-14 of its torsional stiffness): then a shift by so much of the diagonal brings
// it back.
bool factor(BlockTridiagonal& matrix) {
  for (Real shift = 1e-13; !matrix.factor(); shift *= 100) {
    if (!(shift < 1e-6)) return false;
    for (Index i = 0; i < matrix.blocks(); ++i) matrix.diagonal(i).diagonal() *= 1 + shift;
  }
  return true;
}

}  // namespace sutura::thread
