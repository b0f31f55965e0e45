#include "elongation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sutura/archive.h"
#include "sutura/laws/unilateral.h"
#include "sutura/units.h"

namespace sutura::thread {

void Elongation::describe(Describe<Elongation>& d) {
  d.summary("Limits how far a thread can stretch: its fibres lock at a strain.");
  d.theory(
      "On intervals of beams, delta = sum of L (limit - strain) >= 0 with the strain of the arc "
      "(bowing included, "
      "docs/theory/thread.md), so a bend hides no stretch; lambda >= 0 is the tension beyond that "
      "of the "
      "elastic thread (N). Law: unilateral. Intervals end at a beam that is cut or torn.");
  d.attribute("limit", &Elongation::limit, "1", between(1e-6, 10), "Largest strain.");
  d.attribute(
      "interval", &Elongation::interval, between(1, 4),
      "Beams per row: more is cheaper, and the limit then holds for their mean strain. Where "
      "a load or a hand pulls within a row, single beams go beyond it; by more than a tenth "
      "of the limit it is a fault.");
  d.link("thread", &Elongation::thread, "The thread.");
  d.output("tension", "N", "Largest tension that the limit adds.",
           [](const Elongation& e) { return e.largest_force(); });
  d.output("active", "1", "Intervals at their limit.",
           [](const Elongation& e) { return static_cast<Real>(e.active()); });
}

void Elongation::archive(Archive& a) {
  a("largest_force", largest_force_);
  a("active", active_);
  a("strain", strain_);
}

/// A balance of `settle` knows no limit. To draw the thread together at once would throw it.
void Elongation::ready(Setup& setup) {
  const Real most = largest_strain();
  if (most > limit * (1 + 1e-6))
    setup.error(*this, "the thread begins with a strain of " + format_real(most) +
                           ", beyond 'limit'; lay it out shorter ('settle' knows no limit)");
}

/// Of a beam that is whole.
Real Elongation::largest_strain() const {
  const Rod& rod = thread->rod();
  ElementState s;
  Real most = 0;
  for (Index e = 0; e < rod.beams(); ++e) {
    if (rod.is_cut(e)) continue;
    rod.element_state(e, s);
    most = std::max(most, s.strain);
  }
  return most;
}

Elongation::Interval Elongation::interval_from(Index beam) const {
  const Rod& rod = thread->rod();
  while (beam < rod.beams() && rod.is_cut(beam)) ++beam;
  Index last = beam;
  while (last < rod.beams() && last - beam < interval && !rod.is_cut(last)) ++last;
  return {beam, last};
}

void Elongation::build(const StepContext&, ConstraintBuilder& builder) {
  blocks_.clear();
  const Rod& rod = thread->rod();
  for (Index e = 0; e < rod.beams(); ++e) thread->set_limit_tension(e, 0);
  ElementState s;
  Index next = 0;
  while (next < rod.beams()) {
    const auto [first, last] = interval_from(next);
    next = last;
    if (first == last) break;
    // In a rigid stretch nothing gets longer.
    if (rod.stretches().lead(first) == rod.stretches().lead(last)) continue;
    PointJacobian J;
    J.nodes = static_cast<int>(last - first + 1);
    J.width = 6;
    J.coefficients.setZero(3, 6 * J.nodes);
    for (int k = 0; k < J.nodes; ++k) J.node[static_cast<std::size_t>(k)] = first + k;
    // Row of delta: minus the gradient of the arc length. It is written as a motion along the
    // tangent of the interval's first section, so that recorders show the force where it pulls.
    const Pose& at = rod.poses()[first];
    const Vec3 along = at.rotation * Vec3::UnitX();
    Real room = 0, length = 0;
    for (Index e = first; e < last; ++e) {
      const Real L = rod.element(e).length;
      rod.element_state(e, s);
      room += L * (limit - s.strain);
      length += L;
      const Vec9 g = -L * strain_gradient(rod.element(e), s);
      Eigen::Matrix<Real, 1, 12> row;
      row << -g.head<3>().transpose(), g.segment<3>(3).transpose(), g.head<3>().transpose(),
          g.tail<3>().transpose();
      J.coefficients.middleCols<12>(6 * (e - first)) += along * row;
    }
    // Slack intervals make no rows: strain below a hundredth of the limit.
    if (room > 0.99 * limit * length) continue;
    const Key key =
        make_key(source_id_, static_cast<std::uint64_t>(std::llround(1e7 * rod.abscissa()[first])));
    // Its force turns with the beams, which rows do not know.
    const Real known = builder.known_force(key);
    for (Index e = first; e < last; ++e) thread->set_limit_tension(e, known);
    const BlockId block = builder.add<Unilateral>(key, {}, BlockVector<1>(room), Unilateral::open,
                                                  {.force = 0.1, .length = limit * length});
    builder.couple(block, *thread, Eigen::Matrix<Real, 1, 3>(along.transpose()), J, at.position);
    blocks_.push_back(block);
  }
}

void Elongation::commit(const StepContext&, const SolvedBlocks& solved) {
  largest_force_ = 0;
  active_ = 0;
  for (const BlockId& block : blocks_) {
    largest_force_ = std::max(largest_force_, solved.lambda(block)[0]);
    active_ += solved.mode(block) == Unilateral::closed;
  }
  strain_ = largest_strain();
}

std::string Elongation::fault() const {
  if (!(strain_ > 1.1 * limit)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "a beam is stretched by %.2g, beyond 'limit'%s", strain_,
                interval > 1 ? ": 'interval' 1 limits every beam" : "");
  return text;
}

}  // namespace sutura::thread
