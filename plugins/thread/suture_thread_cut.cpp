// How a thread is cut, and how it tears.
#include <cstdio>

#include "suture_thread.h"

namespace sutura::thread {
namespace {

constexpr Real late = 1.1;  // of its strength: what tears with more has torn late

}  // namespace

/// A beam that may be split is lost at its shortest only.
void SutureThread::cut(Real s) {
  Index beam = place(rod_, s).beam;
  release_beam(beam);
  while (sampling_angle > 0 && rod_.element(beam).length >= 2 * shortest_beam) {
    split(beam);
    beam = place(rod_, s).beam;
  }
  rod_.cut(beam);
}

/// Into halves. Scissors close while drivers speak: loads that were told before stay where they
/// are.
void SutureThread::split(Index beam) {
  const Index before = 6 * (beam + 1), beyond = load().size() - before;
  std::vector<Real>& nodes = sampling_work_.nodes;
  nodes = rod_.abscissa();
  nodes.insert(nodes.begin() + beam + 1, middle(beam));
  place_nodes(nodes);
  if (load().size() == 0) return;
  VecX moved = VecX::Zero(rod_.dofs());
  moved.head(before) = load().head(before);
  moved.tail(beyond) = load().tail(beyond);
  load() = moved;
}

/// What is cut is rigid no more.
void SutureThread::release_beam(Index beam) {
  if (rod_.stretches().is_rigid(beam)) release(rod_.stretches().body_of(beam));
}

Real SutureThread::middle(Index beam) const {
  return (rod_.abscissa()[beam] + rod_.abscissa()[beam + 1]) / 2;
}

/// Beams may be split and merged before the next step.
void SutureThread::keep_limits() {
  limits_.clear();
  for (Index e = 0; e < rod_.beams(); ++e)
    if (const Real tension = step_.guess().limit_tension[e]; tension != 0)
      limits_.push_back({rod_.abscissa()[e], rod_.abscissa()[e + 1], tension});
}

Real SutureThread::limit_tension(Index beam) const {
  if (rod_.is_cut(beam)) return 0;
  if (step_.in_step()) return step_.guess().limit_tension[beam];
  const Real at = middle(beam);
  Real sum = 0;
  for (const LimitTension& limit : limits_)
    if (limit.from < at && at < limit.to) sum += limit.tension;
  return sum;
}

/// Of a beam: of its elastic thread, of its viscosity, and what limits of stretch bear.
Real SutureThread::tension_of(Index beam, const ElementState& state) const {
  if (rod_.is_cut(beam)) return 0;
  return state.tension + step_.viscous_tension(beam) + limit_tension(beam);
}

/// Of the beams that may tear.
SutureThread::Taut SutureThread::most_taut() const {
  Taut most;
  ElementState s;
  for (Index e = 0; e < rod_.beams(); ++e) {
    if (rod_.is_cut(e) || rod_.abscissa()[e] < shape_.needle_length) continue;
    rod_.element_state(e, s);
    const Real tension = tension_of(e, s);
    if (tension > most.tension) most = {e, tension};
  }
  return most;
}

void SutureThread::tear() {
  torn_late_ = 0;
  if (strength == 0) return;
  const Taut most = most_taut();
  if (!(most.tension > strength)) return;
  if (most.tension > late * strength) torn_late_ = most.tension;
  cut(middle(most.beam));
}

/// What tears at the end of a step in which it bore far more than it can has drawn at its hands and
/// knots with that.
bool SutureThread::tells_when() const {
  return strength == 0 || most_taut().tension <= late * strength;
}

std::string SutureThread::fault() const {
  if (torn_late_ == 0) return {};
  char text[100];
  std::snprintf(text, sizeof text,
                "it bore %.3g N before it tore: a shorter step, or more substeps", torn_late_);
  return text;
}

}  // namespace sutura::thread
