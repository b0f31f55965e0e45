#include "suture_thread.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "sutura/archive.h"

namespace sutura::thread {

/// Every grasper and load has said where it wants a node.
void SutureThread::ready(Setup&) {
  build();
}

void SutureThread::archive(Archive& a) {
  std::vector<Real> nodes = rod_.abscissa();
  a("abscissae", nodes);
  const bool usable = nodes.size() >= 2 && std::is_sorted(nodes.begin(), nodes.end());
  if (!usable) a.fail("these are no nodes of a thread");
  if (!a.ok()) return;
  if (a.restoring() && nodes != rod_.abscissa()) lay_out(std::move(nodes));
  rod_.archive(a);
  if (a.restoring() && a.ok()) step_.fit(rod_);
  step_.archive(a, rod_);
  a.list("limits", limits_, [](Archive& each, LimitTension& limit) {
    each("from", limit.from);
    each("to", limit.to);
    each("tension", limit.tension);
  });
  a("factored", factored_);
  held_strands_.archive(a, rod_);
}

/// Uniform on needle and thread, with a node at the swage and at every hold. A node closer to a
/// hold than a third of a beam moves there instead of making a sliver.
std::vector<Real> SutureThread::node_abscissae() const {
  std::vector<Real> nodes;
  const auto uniform = [&](Real from, Real length, Index beams) {
    for (Index i = 0; i < beams; ++i)
      nodes.push_back(from + length * static_cast<Real>(i) / static_cast<Real>(beams));
  };
  if (needle_arc_length > 0) uniform(0, needle_arc_length, needle_beams);
  uniform(needle_arc_length, thread_length, thread_beams);
  nodes.push_back(shape_.length());

  std::vector<Real> fixed = {0, needle_arc_length, shape_.length()};
  const auto is_fixed = [&](Real s) {
    return std::any_of(fixed.begin(), fixed.end(), [s](Real f) { return std::abs(f - s) < 1e-12; });
  };
  for (const Real s : holds_) {
    const auto right = std::lower_bound(nodes.begin(), nodes.end(), s);
    const auto near = right == nodes.begin() || *right - s < s - *(right - 1) ? right : right - 1;
    const Real spacing = right == nodes.begin() ? 0 : *right - *(right - 1);
    if (std::abs(*near - s) > 1e-9) {
      if (std::abs(*near - s) < spacing / 3 && !is_fixed(*near))
        *near = s;
      else
        nodes.insert(right, s);
    }
    fixed.push_back(s);
  }
  return nodes;
}

Section SutureThread::section(Real s) const {
  if (s < needle_arc_length)
    return {.radius = needle_diameter / 2,
            .young = needle_young,
            .poisson = needle_poisson,
            .density = needle_density};
  return {.radius = thread_diameter / 2,
          .young = thread_young,
          .poisson = thread_poisson,
          .density = thread_density,
          .bending_factor = bending_factor};
}

/// Beams between these abscissae, at rest where the scene puts them.
void SutureThread::lay_out(std::vector<Real> nodes) {
  RodLayout layout;
  layout.abscissa = std::move(nodes);
  for (const Real s : layout.abscissa) {
    layout.rest.push_back(shape_.rest(s));
    layout.start.push_back(shape_.start(s));
  }
  for (std::size_t e = 0; e + 1 < layout.abscissa.size(); ++e)
    layout.sections.push_back(section((layout.abscissa[e] + layout.abscissa[e + 1]) / 2));
  rod_.build(layout);
  step_.fit(rod_);
  step_.damping = {damping_mass, damping_stiffness};
  if (clamp == Clamp::start || clamp == Clamp::both) rod_.clamp(0);
  if (clamp == Clamp::end || clamp == Clamp::both) rod_.clamp(rod_.nodes() - 1);
  for (const Real s : holds_) {
    const CurvePlace at = place(rod_, s);
    rod_.springs().emplace_back().node = at.beam + (at.u > 0.5 ? 1 : 0);
  }
}

void SutureThread::build() {
  lay_out(node_abscissae());
  rules_ = {.angle = sampling_angle,
            .shortest = shortest_beam,
            .longest = thread_length / static_cast<Real>(thread_beams),
            .from = needle_arc_length,
            .forced = holds_};
  // A beam is split only above twice the shortest: so many beams at most, next to those there are
  // now.
  limits_.reserve(static_cast<std::size_t>(rod_.beams()));
  if (sampling_angle > 0) {
    const Index most = rod_.beams() + static_cast<Index>(thread_length / shortest_beam);
    limits_.reserve(static_cast<std::size_t>(most));
    sampling_work_.reserve(static_cast<std::size_t>(most));
    rod_.reserve(most);
    step_.reserve(most);
    resampler_.reserve(rod_, most);
    sample_start();
  }
  held_strands_.begin(rod_);
  start_moving();
}

/// As many beams as the bends at rest and at the start ask for, before anything moves: nodes that
/// come later lie on the cubics of coarser beams.
void SutureThread::sample_start() {
  constexpr int levels = 20;  // a beam is a millionth as long then
  for (int i = 0; i < levels && sample(rod_, rules_, sampling_work_); ++i)
    lay_out(sampling_work_.nodes);
}

void SutureThread::begin_step(const StepContext& context) {
  factored_ = true;
  step_.set_load(load());
  step_.begin(rod_, context.dt, context.gravity, context.order);
}

void SutureThread::linearise(const StepContext&, const VecX& force) {
  factored_ = step_.linearise(rod_, force);
}

void SutureThread::push(const StepContext&, const VecX& force_change) {
  if (factored_) step_.push(rod_, force_change);
}

void SutureThread::correct(const StepContext&) {
  if (factored_) step_.correct(rod_);
}

Imbalance SutureThread::imbalance(const StepContext&, const VecX& force) {
  constexpr Real none = std::numeric_limits<Real>::infinity();
  return factored_ ? step_.imbalance(rod_, force) : Imbalance{none, none};
}

bool SutureThread::leave_saddle() {
  return factored_ && step_.leave_saddle(rod_);
}

bool SutureThread::goes_on_as_before(const StepContext&) {
  return step_.goes_on_as_before(rod_);
}

void SutureThread::end_step(const StepContext&, const VecX& force) {
  held_strands_.end_step(rod_, step_.time_error(rod_));
  step_.end(rod_, force);
  keep_limits();
  tear();
  if (sampling_angle > 0) resample();
}

void SutureThread::resample() {
  sampling_change_ = 0;
  if (!rod_.finite() || !sample(rod_, rules_, sampling_work_)) return;
  const Real elastic = rod_.elastic_energy(), energy = elastic + rod_.kinetic_energy();
  place_nodes(sampling_work_.nodes);
  if (energy > 0) sampling_change_ = std::abs(rod_.elastic_energy() - elastic) / energy;
}

void SutureThread::place_nodes(const std::vector<Real>& abscissae) {
  resampler_.apply(
      rod_, abscissae, [&](Real s) { return shape_.rest(s); }, [&](Real s) { return section(s); });
  step_.fit(rod_);
}

void SutureThread::solve(Eigen::Ref<MatX> columns) const {
  step_.answer(rod_, columns);
}

std::string SutureThread::trouble() const {
  if (!rod_.finite()) return "the state is no longer finite";
  if (!factored_) return "the matrix of the step is not positive definite";
  if (step_.is_stuck())
    return "it is pushed together, and may have missed how it buckles: try a shorter step";
  if (sampling_change_ > 0.01) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "as its beams were split or merged its energy changed by %.1f %%: they bent too "
                  "far in one step; a shorter step, or more thread_beams",
                  100 * sampling_change_);
    return text;
  }
  const std::string doubt = held_strands_.doubt(rod_, step_.guess());
  return doubt.empty() ? coarse_bend() : doubt;
}

/// A cubic has no shape for a beam whose ends turn further than that against its chord: it snaps
/// from one to the next as the thread is drawn round a corner.
std::string SutureThread::coarse_bend() const {
  constexpr Real most = 1;  // rad
  Real largest = most;
  Index where = -1;
  for (Index e = 0; e < rod_.beams(); ++e) {
    const ElementState& s = step_.guess().beams[e];
    const Real turn = s.theta_a.norm() + s.theta_b.norm();
    if (rod_.is_cut(e) || !(turn > largest)) continue;
    largest = turn;
    where = e;
  }
  if (where < 0) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "the beam at %.1f mm bends by %.1f rad: too long for that; more thread_beams, or "
                "sampling_angle",
                1e3 * rod_.abscissa()[where], largest);
  return text;
}

Real SutureThread::radius(Real s) const {
  return (s < shape_.needle_length ? needle_diameter : thread_diameter) / 2;
}

Index SutureThread::add_hold(Real s) {
  holds_.push_back(std::clamp(s, 0., length()));
  return static_cast<Index>(holds_.size()) - 1;
}

void SutureThread::set_hold(Index hold, const Pose& target, const HoldStiffness& stiffness) {
  NodeSpring& spring = rod_.springs()[hold];
  if (!spring.active) spring.last_target = target.position;
  spring.active = true;
  spring.target = target;
  spring.stiffness = stiffness;
}

void SutureThread::release_hold(Index hold) {
  NodeSpring& spring = rod_.springs()[hold];
  spring.active = false;
  spring.roll = 0;
  spring.applied = {};
}

Wrench SutureThread::hold_wrench(Index hold) const {
  return rod_.springs()[hold].applied;
}

Real SutureThread::held_power() const {
  Real power = 0;
  for (const NodeSpring& s : rod_.springs()) {
    if (!s.active) continue;
    power += s.applied.force.dot(rod_.velocity().segment<3>(6 * s.node)) +
             s.applied.moment.dot(rod_.velocity().segment<3>(6 * s.node + 3));
  }
  return power;
}

Real SutureThread::largest_strain() const {
  Real largest = 0;
  ElementState s;
  for (Index e = 0; e < rod_.beams(); ++e) {
    if (rod_.is_cut(e)) continue;
    rod_.element_state(e, s);
    largest = std::max(largest, std::abs(s.strain));
  }
  return largest;
}

Real SutureThread::largest_curvature() const {
  Real largest = 0;
  for (Index e = 0; e < rod_.beams(); ++e)
    if (!rod_.is_cut(e)) largest = std::max(largest, beam_curvature(rod_, e));
  return largest;
}

/// A needle is drawn with a point three diameters long. The mechanics does not know it: there the
/// needle is as thick as ever, up to abscissa 0.
Real SutureThread::drawn_radius(Real s) const {
  const Real point = 3 * needle_diameter;
  return s < std::min(point, shape_.needle_length) ? radius(s) * s / point : radius(s);
}

BodyGeometry SutureThread::geometry() const {
  BodyGeometry g;
  g.cell = BodyGeometry::Cell::line;
  BodyGeometry::Field velocity{"velocity [m/s]", false, 3, {}};
  BodyGeometry::Field abscissa{"abscissa [m]", false, 1, {}};
  BodyGeometry::Field drawn{"drawn radius [m]", false, 1, {}};
  BodyGeometry::Field radius_field{"radius [m]", true, 1, {}};
  BodyGeometry::Field tension{"axial force [N]", true, 1, {}};
  BodyGeometry::Field bend{"curvature [1/m]", true, 1, {}};
  for (Index i = 0; i < rod_.nodes(); ++i) {
    g.points.push_back(rod_.poses()[i].position);
    abscissa.values.push_back(rod_.abscissa()[i]);
    drawn.values.push_back(drawn_radius(rod_.abscissa()[i]));
    for (int k = 0; k < 3; ++k) velocity.values.push_back(rod_.velocity()[6 * i + k]);
  }
  ElementState s;
  for (Index e = 0; e < rod_.beams(); ++e) {
    if (rod_.is_cut(e)) continue;
    g.connectivity.push_back(e);
    g.connectivity.push_back(e + 1);
    rod_.element_state(e, s);
    radius_field.values.push_back(rod_.section(e).radius);
    tension.values.push_back(tension_of(e, s));
    bend.values.push_back(beam_curvature(rod_, e));
  }
  g.fields = {velocity, abscissa, drawn, radius_field, tension, bend};
  return g;
}

}  // namespace sutura::thread
