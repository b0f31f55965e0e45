#include "rod_step.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "common_motion.h"
#include "element_mass.h"
#include "rod_potential.h"

namespace sutura::thread {

namespace {

/// Forces below this share of the largest in the rod are taken for rounding where nothing else is
/// at work, and so are moments about the tangent beside others.
constexpr Real negligible = 1e-6;

/// What is missing of balance at a node, r (N, N m), as a share of what is at work there. Roll is
/// judged by itself: the force of a taut thread times the length of a beam may be a million times
/// what twists it.
/// Forces and bending moments below `rounding` (N, N m) count for nothing.
Real share(const Vec6& r, const Vec3& tangent, const AtWork& at_work, const ElementRest& beam,
           const AtWork& rounding) {
  // rad in a beam: where less is at work, roll is judged beside it. What is left of roll is felt as
  // friction by strands that roll on each other: with the default tolerance and beams of a
  // diameter, 0.1 mN a node in a thread of 0.2 mm.
  constexpr Real twist = 0.03;
  AtWork missing;
  missing.force = std::max(Real(0), r.head<3>().norm() - rounding.force);
  missing.add_moment(r.tail<3>(), tangent);
  missing.bending = std::max(Real(0), missing.bending - rounding.bending);
  const Real force = at_work.force + at_work.bending / beam.length;
  const Real roll = at_work.roll + twist * beam.torsion + negligible * force * beam.length;
  const auto part = [](Real of, Real whole) { return of > 0 ? of / whole : 0; };
  return std::max({part(missing.force, force), part(missing.bending, force * beam.length),
                   part(missing.roll, roll)});
}

}  // namespace

void RodStep::fit(const Rod& rod) {
  const Index n = rod.nodes();
  start_.resize(n);
  now_.resize(n);
  before_.resize(n);
  guess_.resize(n);
  way_.resize(n);
  matrix_.resize(rod.stretches().blocks());
  for (auto* v : {&change_, &answer_, &stays_, &last_force_, &common_}) v->clear(6 * n);
  viscous_tension_.assign(static_cast<std::size_t>(n - 1), 0);
  in_step_ = false;
}

void RodStep::reserve(Index beams) {
  const Index n = beams + 1;
  start_.reserve(n);
  now_.reserve(n);
  before_.reserve(n);
  guess_.reserve(n);
  way_.reserve(n);
  matrix_.reserve(n);
  for (auto* v : {&change_, &answer_, &stays_, &last_force_, &common_}) v->reserve(6 * n);
  viscous_tension_.reserve(static_cast<std::size_t>(n));
}

void RodStep::archive(Archive& a, const Rod& rod) {
  last_force_.archive(a, "force");
  if (last_force_.size() != rod.dofs()) a.fail("the state of another thread");
  before_.archive(a, rod);
  a("kinetic_energy", kinetic_energy_);
  a("viscous_tension", viscous_tension_);
  if (viscous_tension_.size() + 1 != static_cast<std::size_t>(rod.nodes()))
    a.fail("the state of another thread");
  if (a.restoring()) in_step_ = false;
}

void RodStep::set_load(const VecX& load) {
  assert(load.size() == 0 || load.size() == start_.load.size());
  if (load.size() > 0)
    start_.load = load;
  else
    start_.load.setZero();
}

/// What the step begins from, one step back or two.
void RodStep::set_start(Real dt) {
  const Real w = before_.length > 0 ? dt / before_.length : 0;
  constexpr Real longest = 2;  // beside the step before
  const bool two_back = order_ == 2 && w > 0 && w <= longest;
  share_ = two_back ? w * w / (1 + 2 * w) : 0;
  start_.dt = two_back ? dt * (1 + w) / (1 + 2 * w) : dt;
  if (two_back) {
    start_.extrapolate(now_, before_.start, share_);
    start_.carried.scale(before_.motion, share_);
  } else {
    static_cast<RodMoment&>(start_) = now_;
    start_.carried.set_zero();
  }
}

void RodStep::begin(Rod& rod, Real dt, const Vec3& gravity, Index order) {
  assert(guess_.motion.size() == rod.dofs());  // else `fit` was forgotten
  start_.gravity = gravity;
  start_.damping = damping;
  if (!in_step_) {
    constexpr Real clearly = 1.1;
    find_common_motion(rod, last_force_, dt, common_);
    change_ = rod.velocity();
    rod.velocity() -= common_;
    const Real energy = rod.kinetic_energy();
    rod.velocity() = change_;
    speeds_up_ = energy > clearly * kinetic_energy_;
    kinetic_energy_ = energy;
    rod.mark_start();
    start_.twist = rod.twist();
    now_.take(rod, damping.stiffness > 0);
  }
  in_step_ = true;
  length_ = dt;
  order_ = order;
  set_start(dt);
  guess_.force.at = last_force_;
  passes_ = 0;
  stay(rod);
  const bool pushed = !last_force_.isZero(0);
  const Real lacks = pushed ? imbalance(rod, last_force_).relative : 0;
  change_ = guess_.missing;
  // Going on as before is the better guess, unless it turns beams too far for anything to be
  // linear. A rod that nothing holds also falls.
  const Real h = start_.dt;
  answer_ = start_.carried.shift_and_tilt + h * start_.velocity;
  for (Index i = 0; i < rod.nodes() && share_ > 0; ++i)
    answer_.segment<3>(6 * i + 3) += start_.carried.roll[i] * tangent(rod.poses()[i]);
  const bool falls = !pushed && !rod.is_held();
  for (Index i = 0; i < rod.nodes() && falls; ++i) answer_.segment<3>(6 * i) += h * h * gravity;
  rod.stretches().spread(rod.poses(), answer_);
  if (largest_turn(rod, Configuration::start, answer_) > turn_limit) return;
  way_.aim(rod, guess_, answer_);
  way_.go(rod, start_, guess_, 1);
  if (pushed && !speeds_up_ && goes_uphill(lacks, rod)) stay(rod);
}

/// The guess that nothing moves but the rod as a whole.
void RodStep::stay(Rod& rod) {
  guess_.motion.setZero();
  guess_.move(rod, start_);
  guess_.take_tension();
  if (!common_.isZero(0)) {
    answer_ = length_ * common_;
    rod.stretches().spread(rod.poses(), answer_);
    way_.aim(rod, guess_, answer_);
    way_.go(rod, start_, guess_, 1);
  }
  stays_ = guess_.motion;
}

/// Whether the guess that goes on has a higher potential than the one that stays, under the forces
/// of the last step, and is clearly less balanced: then stiffness decides how the rod moves, and
/// not inertia. A knot that goes on by a whole beam in every step finds the same balance there, for
/// ever; what has lost its balance speeds up, and is let go on.
/// `lacks`: the relative imbalance of the one that stays; `change_`: what it is missing.
bool RodStep::goes_uphill(Real lacks, const Rod& rod) {
  constexpr Real clearly = 2;
  // The mean of the forces at both ends of the way; a difference of energies drowns in rounding.
  change_ = (change_ + guess_.missing) / 2 + start_.dt * last_force_;
  return change_.dot(guess_.motion - stays_) < 0 &&
         imbalance(rod, last_force_).relative > clearly * lacks;
}

bool RodStep::linearise(const Rod& rod, const Dofs& force) {
  stuck_ = false;
  // Passes for loops that swing and for strands that roll take turns.
  constexpr Real rolls_on_itself = 0.3;
  guess_.chord_roll = passes_++ % 2 == 0 ? 1 : rolls_on_itself;
  guess_.force.at = force;
  assemble(rod, start_, guess_, Tangent::exact, matrix_);
  if (!matrix_.factor()) {  // something buckles: go downhill
    assemble(rod, start_, guess_, Tangent::convex, matrix_);
    if (!factor(matrix_)) return false;
  }
  change_ = guess_.missing + start_.dt * force;
  answer(rod, change_);
  moments_.turn(
      rod, start_.load, start_.dt * start_.dt, [&](MatX& x) { answer(rod, x); }, change_);
  return true;
}

void RodStep::answer(const Rod& rod, Eigen::Ref<MatX> columns) const {
  const Stretches& stretches = rod.stretches();
  stretches.pack(rod.poses(), columns);
  for (const Index node : rod.clamped()) columns.middleRows<6>(6 * stretches.block(node)).setZero();
  auto free = columns.topRows(6 * matrix_.blocks());
  if (columns.cols() == 1)
    matrix_.solve(Eigen::Ref<VecX>(free.col(0)));
  else
    matrix_.solve(Eigen::Ref<MatX>(free));
  stretches.unpack(rod.poses(), columns);
}

void RodStep::push(const Rod& rod, const Dofs& force_change) {
  if (force_change.isZero(0)) return;
  guess_.force.at += force_change;
  answer_ = force_change;
  answer(rod, answer_);
  change_ += start_.dt * answer_;
}

void RodStep::correct(Rod& rod) {
  guess_.force.hold(rod);
  answer_ = start_.dt * change_;
  const Real turn = largest_turn(rod, Configuration::current, answer_);
  Real part = std::min(1., turn_limit / turn);
  way_.aim(rod, guess_, answer_);
  way_.predict_tension(rod, guess_, part);
  // Only what lowers the potential is taken; below a milliradian its changes drown in rounding.
  const bool small = turn < 1e-3;
  const Real before = small ? 0 : potential(rod, start_, guess_);
  way_.go(rod, start_, guess_, part);
  for (int cut = 0; cut < 12 && !small && !(potential(rod, start_, guess_) <= before); ++cut) {
    part /= 2;
    way_.go(rod, start_, guess_, part);
  }
  part_way_ = part < 1;
}

void RodStep::move_to(Rod& rod, const VecX& motion) {
  guess_.motion = motion;
  guess_.move(rod, start_);
}

Imbalance RodStep::imbalance(const Rod& rod, const Dofs& force) const {
  Imbalance worst;
  const Stretches& stretches = rod.stretches();
  Real everywhere = 0;
  for (const AtWork& w : guess_.at_work) everywhere = std::max(everywhere, w.force);
  for (Index i = 0; i < rod.nodes(); ++i) {
    if (rod.is_clamped(i) || stretches.follows(i)) continue;
    Vec6 r = guess_.missing.segment<6>(6 * i) / start_.dt;
    AtWork scale = guess_.at_work[i];
    scale.force += negligible * everywhere;
    for (Index k = i; k < rod.nodes() && stretches.lead(k) == i; ++k) {
      r += stretches.on_leader(rod.poses(), k, force.segment<6>(6 * k));
      scale.force += force.segment<3>(6 * k).norm();
      scale.add_moment(force.segment<3>(6 * k + 3), tangent(rod.poses()[k]));
    }
    // A beam that is cut says nothing of how stiff the rod is here.
    const Index after = std::min(i, rod.beams() - 1), before = std::max(i - 1, Index{0});
    const ElementRest& beam = rod.element(rod.is_cut(after) ? before : after);
    // A position is rounded by up to an ulp, and a beam is stretched and turned by that. What turns
    // both of its ends against the chord bends it with six times its stiffness.
    const Vec3& place = rod.poses()[i].position;
    const Real ulp = std::numeric_limits<Real>::epsilon() * place.lpNorm<Eigen::Infinity>();
    const Real share_of_length = ulp / beam.length * (1 + start_.damping.stiffness / start_.dt);
    AtWork rounding;
    rounding.force = share_of_length * beam.axial;
    rounding.bending = share_of_length * 6 * std::max(beam.bend_1, beam.bend_2);
    const Real relative = share(r, tangent(rod.poses()[i]), scale, beam, rounding);
    const Real size = std::max(r.head<3>().norm(), r.tail<3>().norm() / beam.length);
    // What is not a number at one node stays so: the next one must not hide it.
    if (!std::isfinite(size)) return {size, size};
    worst.force = std::max(worst.force, size);
    worst.relative = std::max(worst.relative, relative);
  }
  worst.relative = std::max(
      {worst.relative, imbalance_of_whole(rod, force, everywhere), imbalance_of_roll(rod, force)});
  return worst;
}

/// What is missing about the tangents, summed over any stretch of the rod, beside a friction of
/// 0.01 of what pushes the rod, and its torsion. As a rod rolls far on something, what its nodes
/// lack has one sign, and is felt as a drag across the rod, however little each of them lacks. Only
/// nodes count that turn by more than a radian in the step, or would if they went on as they began:
/// where they do not turn at the guess, they are dragged.
Real RodStep::imbalance_of_roll(const Rod& rod, const Dofs& force) const {
  constexpr Real far = 1;  // rad
  constexpr Real friction = 0.01;
  const Stretches& stretches = rod.stretches();
  Real sum = 0, least = 0, most = 0, pushed = 0, torsion = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    pushed += force.segment<3>(6 * i).norm() * rod.section(std::min(i, rod.beams() - 1)).radius;
    const bool leads = i + 1 < rod.nodes() && stretches.lead(i + 1) == i;
    if (leads || stretches.follows(i) || rod.is_clamped(i)) continue;
    const Vec3& along = tangent(rod.poses()[i]);
    const auto turn = [&](const DofVector& velocity) {
      return length_ * std::abs(along.dot(velocity.segment<3>(6 * i + 3)));
    };
    if (std::max(turn(rod.velocity()), turn(start_.velocity)) < far) continue;
    const Real moment = along.dot(force.segment<3>(6 * i + 3));
    sum += along.dot(guess_.missing.segment<3>(6 * i + 3)) / start_.dt + moment;
    torsion = std::max(torsion, guess_.at_work[i].roll + std::abs(moment));
    least = std::min(least, sum);
    most = std::max(most, sum);
  }
  return pushed > 0 ? (most - least) / (friction * pushed + torsion) : Real(0);
}

/// What is missing of the balance of all of a rod, beside the forces from outside and of inertia. A
/// light thread with a tight knot weighs less than what its nodes there may be out of balance.
Real RodStep::imbalance_of_whole(const Rod& rod, const Dofs& force, Real everywhere) const {
  if (!rod.clamped().empty()) return 0;
  Vec3 missing = Vec3::Zero(), pushed = Vec3::Zero();
  Real at_work = rod.mass() * start_.gravity.norm(), rounding = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    missing += guess_.missing.segment<3>(6 * i) / start_.dt;
    pushed += force.segment<3>(6 * i);
    at_work += start_.load.segment<3>(6 * i).norm();
  }
  for (Index e = 0; e < rod.beams(); ++e) {
    const auto mean = [e](const DofVector& v) {
      return Vec3((v.segment<3>(6 * e) + v.segment<3>(6 * e + 6)) / 2);
    };
    rounding = std::max(rounding, 2 * strain_rounding * rod.element(e).axial);
    const Vec3 now = mean(rod.velocity());
    at_work += rod.element(e).mass * ((now - mean(start_.velocity)).norm() / start_.dt +
                                      start_.damping.mass * now.norm());
  }
  for (const NodeSpring& spring : rod.springs())
    if (spring.active) at_work += guess_.wrench(rod, spring).force.norm();
  at_work += pushed.norm() + rounding;
  const Real beyond = (missing + pushed).norm() - negligible * everywhere;
  return beyond > 0 ? beyond / at_work : Real(0);
}

Real RodStep::time_error(const Rod& rod) const {
  Real most = 0;
  for (Index i = 0; i < rod.nodes(); ++i) {
    if (rod.is_held(i)) continue;
    Vec3 change = rod.velocity().segment<3>(6 * i) - now_.velocity.segment<3>(6 * i);
    if (share_ > 0)
      change -=
          length_ / before_.length * (now_.velocity - before_.start.velocity).segment<3>(6 * i);
    most = std::max(most, change.squaredNorm());
  }
  constexpr Real bdf2 = 2. / 9;  // of h^3 times the third derivative, with equal steps
  return (share_ > 0 ? bdf2 : 0.5) * length_ * std::sqrt(most);
}

void RodStep::go_back(Rod& rod) {
  if (!in_step_) return;
  rod.poses() = rod.poses(Configuration::start);
  rod.twist() = start_.twist;
  rod.velocity() = now_.velocity;
  in_step_ = false;
}

void RodStep::end(Rod& rod, const Dofs& force) {
  if (force.size() > 0)
    last_force_ = force;
  else
    last_force_.setZero();
  for (NodeSpring& spring : rod.springs()) {
    if (!spring.active) continue;
    spring.last_target = spring.target.position;
    spring.roll = guess_.roll(rod, spring);
    spring.applied = spring.wrench(rod.poses()[spring.node], spring.roll);
  }
  for (Index e = 0; e < rod.beams() && damping.stiffness > 0; ++e)
    viscous_tension_[e] = damping.stiffness / start_.dt * rod.element(e).axial *
                          (guess_.beams[e].strain - start_.deformation[e].strain);
  before_.length = 0;
  if (order_ == 2) {
    before_.length = length_;
    before_.start = now_;
    before_.motion.take(rod, guess_.motion);
  }
  in_step_ = false;
}

Index RodStep::advance(Rod& rod, Real dt, const Vec3& gravity, const Dofs& force, Real tolerance) {
  constexpr Index most = 100;
  begin(rod, dt, gravity);
  Index passes = 0;
  while (passes < most && linearise(rod, force)) {
    correct(rod);
    ++passes;
    if (!(imbalance(rod, force).relative > tolerance)) break;
  }
  const bool balanced = imbalance(rod, force).relative <= tolerance;
  end(rod, force);
  return balanced ? passes : 0;
}

}  // namespace sutura::thread
