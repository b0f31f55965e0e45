// Rigid stretches of a thread, as others ask for them, and the rows of the thread where there are
// some.
#include <algorithm>
#include <cmath>

#include "suture_thread.h"

namespace sutura::thread {

std::optional<std::pair<Real, Real>> SutureThread::rigid_range(Real from, Real to) const {
  const Index first = place(rod_, from).beam, last = place(rod_, to).beam + 1;
  for (Index e = first; e < last; ++e)
    if (rod_.is_cut(e)) return {};
  for (Index i = first; i <= last; ++i) {
    const bool joins = (i > 0 && rod_.stretches().is_rigid(i - 1)) ||
                       (i < rod_.beams() && rod_.stretches().is_rigid(i));
    if (joins || rod_.is_clamped(i)) return {};
  }
  return std::pair{rod_.abscissa()[first], rod_.abscissa()[last]};
}

Index SutureThread::node_at(Real s) const {
  const CurvePlace at = place(rod_, s);
  return at.beam + (at.u > 0.5 ? 1 : 0);
}

void SutureThread::make_rigid(Index body, Real from, Real to) {
  rod_.make_rigid({body, node_at(from), node_at(to)});
  step_.fit(rod_);
}

void SutureThread::release(Index body) {
  if (!rod_.release(body)) return;
  step_.go_back(rod_);
  step_.fit(rod_);
}

bool SutureThread::is_rigid(Index body) const {
  const auto& all = rod_.stretches().all();
  return std::any_of(all.begin(), all.end(),
                     [body](const RigidStretch& each) { return each.body == body; });
}

Wrench SutureThread::end_wrench(Real s, bool of_the_one_before) const {
  const Index beam = node_at(s) - of_the_one_before;
  if (beam < 0 || beam >= rod_.beams()) return {};
  ElementState state;
  rod_.element_state(beam, state);
  ElementGradient g = gradient(rod_.element(beam), state);
  if (const Real limit = limit_tension(beam); limit != 0) {
    const Vec9 draws =
        limit * rod_.element(beam).length * strain_gradient(rod_.element(beam), state);
    g.v += draws.head<3>(), g.a += draws.segment<3>(3), g.b += draws.tail<3>();
  }
  return of_the_one_before ? Wrench{-g.v, -g.b} : Wrench{g.v, -g.a};
}

/// Rows of followers become rows of their leaders.
void SutureThread::add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const {
  const Stretches& stretches = rod_.stretches();
  if (stretches.empty()) {
    compliance_.add(step_.matrix(), rod_.clamped(), rows, dt, W);
    return;
  }
  led_rows_ = rows;
  for (std::size_t e = 0; e < rows.node.size(); ++e) {
    Eigen::Map<Vec6> row(&led_rows_.value[6 * e]);
    row = stretches.on_leader(rod_.poses(), rows.node[e], row);
    led_rows_.node[e] = stretches.block(rows.node[e]);
  }
  led_clamps_.clear();
  for (const Index node : rod_.clamped()) led_clamps_.push_back(stretches.block(node));
  compliance_.add(step_.matrix(), led_clamps_, led_rows_, dt, W);
}

}  // namespace sutura::thread
