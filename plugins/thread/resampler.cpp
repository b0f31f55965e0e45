#include "resampler.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "chain_motion.h"
#include "curve.h"

namespace sutura::thread {

namespace {

/// Velocity and spin of the moving cubic at a place within a beam.
Vec6 velocity_at(const Rod& rod, const CurvePlace& at) {
  const Index e = at.beam;
  const auto& p = rod.poses();
  const DofVector& v = rod.velocity();
  const Real L = rod.element(e).length;
  const Vec3 ta = tangent(p[e]), tb = tangent(p[e + 1]);
  const Vec3 va = v.segment<3>(6 * e), wa = v.segment<3>(6 * e + 3);
  const Vec3 vb = v.segment<3>(6 * e + 6), wb = v.segment<3>(6 * e + 9);
  const auto rate = [&](const std::array<Real, 4>& w) {
    return Vec3(w[0] * va + w[1] * L * wa.cross(ta) + w[2] * vb + w[3] * L * wb.cross(tb));
  };
  const Vec3 slope = Cubic(p[e], p[e + 1], L).slope(at.u);
  const Vec3 t = slope.normalized();
  const Real roll = (1 - at.u) * wa.dot(ta) + at.u * wb.dot(tb);
  Vec6 out;
  out.head<3>() = rate(Cubic::weights(at.u));
  out.tail<3>() = t.cross(rate(Cubic::weight_slopes(at.u))) / slope.norm() + roll * t;
  return out;
}

}  // namespace

void Resampler::reserve(const Rod& rod, Index beams) {
  const auto nodes = static_cast<std::size_t>(beams) + 1;
  layout_.abscissa.reserve(nodes);
  layout_.rest.reserve(nodes);
  layout_.start.reserve(nodes);
  layout_.sections.reserve(nodes);
  layout_.cut.reserve(nodes);
  velocity_.reserve(6 * static_cast<Index>(nodes));
  for (auto* reals : {&twist_, &old_abscissa_}) reals->reserve(nodes);
  changed_.reserve(nodes);
  wholes_.reserve(nodes);
  clamped_.reserve(rod.clamped().size());
  springs_.reserve(rod.springs().size());
  concerned_.reserve(nodes + 2);
}

void Resampler::apply(Rod& rod, const std::vector<Real>& abscissa,
                      const std::function<Pose(Real)>& rest,
                      const std::function<Section(Real)>& section) {
  Vec6 before;
  before.head<3>() = rod.momentum();
  before.tail<3>() = rod.angular_momentum();
  layout_.abscissa = abscissa;
  plan_nodes(rod, rest, section);
  plan_halves(rod);
  plan_twist(rod);
  plan_cuts(rod);
  mark_neighbours(rod);
  rebuild(rod);
  keep_strain(rod);
  // A clamp gives the rod whatever momentum it needs, and must not move.
  if (rod.clamped().empty()) keep_momentum(rod, before);
}

void Resampler::plan_nodes(const Rod& rod, const std::function<Pose(Real)>& rest,
                           const std::function<Section(Real)>& section) {
  const std::vector<Real>& abscissa = layout_.abscissa;
  const std::size_t n = abscissa.size();
  layout_.rest.clear();
  layout_.start.clear();
  layout_.sections.clear();
  velocity_.clear(6 * static_cast<Index>(n));
  changed_.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const CurvePlace at = place(rod, abscissa[i]);
    const bool old = at.u < 1e-9 || at.u > 1 - 1e-9;
    const Index node = at.beam + (at.u > 0.5 ? 1 : 0);
    layout_.rest.push_back(old ? rod.poses(Configuration::rest)[node] : rest(abscissa[i]));
    layout_.start.push_back(old ? rod.poses()[node]
                                : curve_frame(rod, abscissa[i], Configuration::current));
    velocity_.segment<6>(6 * static_cast<Index>(i)) =
        old ? Vec6(rod.velocity().segment<6>(6 * node)) : velocity_at(rod, at);
    changed_[i] = !old;
    if (i > 0) layout_.sections.push_back(section((abscissa[i - 1] + abscissa[i]) / 2));
  }
}

void Resampler::plan_halves(const Rod& rod) {
  const std::vector<Real>&old = rod.abscissa(), &abscissa = layout_.abscissa;
  const std::size_t n = abscissa.size();
  wholes_.assign(n, {});
  ElementState state;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const Index beam = place(rod, abscissa[k]).beam;
    if (!changed_[k] || std::abs(abscissa[k - 1] - old[beam]) > 1e-12 ||
        std::abs(abscissa[k + 1] - old[beam + 1]) > 1e-12)
      continue;
    rod.element_state(beam, state);
    wholes_[k] = {true, state.strain, elastic_energy(rod.element(beam), state)};
  }
}

/// Twist is spread evenly over a beam: a new beam takes its share of each old one it covers.
void Resampler::plan_twist(const Rod& rod) {
  const std::vector<Real>&old = rod.abscissa(), &abscissa = layout_.abscissa;
  const std::size_t n = abscissa.size();
  twist_.assign(n - 1, 0);
  std::size_t i = 0;
  for (Index e = 0; e < rod.beams(); ++e)
    for (i = i > 0 ? i - 1 : 0; i + 1 < n && abscissa[i] < old[e + 1]; ++i) {
      const Real common = std::min(abscissa[i + 1], old[e + 1]) - std::max(abscissa[i], old[e]);
      if (common > 0) twist_[i] += rod.twist()[e] * common / rod.element(e).length;
      if (abscissa[i + 1] < old[e + 1]) continue;
      ++i;
      break;
    }
}

/// Beams that are cut keep their ends.
void Resampler::plan_cuts(const Rod& rod) {
  const std::vector<Real>& abscissa = layout_.abscissa;
  layout_.cut.clear();
  for (Index e = 0; e < rod.beams(); ++e) {
    if (!rod.is_cut(e)) continue;
    const auto from = std::lower_bound(abscissa.begin(), abscissa.end(), rod.abscissa()[e] - 1e-12);
    layout_.cut.push_back(from - abscissa.begin());
  }
}

/// The neighbours of a node that goes give momentum back too.
void Resampler::mark_neighbours(const Rod& rod) {
  const std::vector<Real>& abscissa = layout_.abscissa;
  for (const Real old : rod.abscissa()) {
    const auto right = std::lower_bound(abscissa.begin(), abscissa.end(), old - 1e-12);
    if (right != abscissa.end() && std::abs(*right - old) < 1e-12) continue;
    const auto b = static_cast<std::size_t>(right - abscissa.begin());
    changed_[b - 1] = changed_[b] = 1;
  }
}

/// As planned, with the clamps and springs that it has.
void Resampler::rebuild(Rod& rod) {
  clamped_ = rod.clamped();
  springs_ = rod.springs();
  old_abscissa_ = rod.abscissa();
  stretches_ = rod.stretches().all();
  rod.build(layout_);
  const auto moved = [this](Index node) {
    const std::vector<Real>& now = layout_.abscissa;
    const auto it = std::lower_bound(now.begin(), now.end(), old_abscissa_[node] - 1e-12);
    return static_cast<Index>(it - now.begin());
  };
  for (const Index node : clamped_) rod.clamp(moved(node));
  for (NodeSpring& spring : springs_) {
    spring.node = moved(spring.node);
    rod.springs().push_back(spring);
  }
  for (const RigidStretch& s : stretches_) rod.make_rigid({s.body, moved(s.first), moved(s.last)});
  rod.twist() = twist_;
  rod.velocity() = velocity_;
}

/// Arc lengths of the cubic and of the beams differ in the fourth power of the angle; times EA
/// that is seen. So the new node of a split beam gives way, as little as keeps the strain of the
/// whole in both halves. In a beam that is all but straight, and bent at rest, that little is much
/// bending for next to no strain: there it goes only so far as the two together cost least, or not
/// at all, whichever keeps the energy.
void Resampler::keep_strain(Rod& rod) const {
  for (Index k = 1; k + 1 < rod.nodes(); ++k) {
    if (!wholes_[k].split) continue;
    constexpr Real kept = 0.005;  // of the energy, as in a merge
    constexpr std::array<Real, 3> softness = {1e-9, 1, 1e30};
    const Pose on_cubic = rod.poses()[k];
    Pose best = on_cubic;
    Real least = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < softness.size() && least > kept * wholes_[k].energy; ++i) {
      rod.poses()[k] = on_cubic;
      give_way(rod, k, softness[i]);
      const Real change = std::abs(energy_change(rod, k));
      if (!(change < least)) continue;
      least = change;
      best = rod.poses()[k];
    }
    rod.poses()[k] = best;
    ElementState s;
    for (const Index e : {k - 1, k}) {
      rod.element_state(e, s);
      rod.twist()[e] = s.twist;
    }
  }
}

/// Moves the node to where the energy of its shift and tilt as a pair of straight beams holds it,
/// times `softness`, and the energy of what strain the halves then have too much is least.
void Resampler::give_way(Rod& rod, Index node, Real softness) const {
  const ElementRest &left = rod.element(node - 1), &right = rod.element(node);
  const Real length = (left.length + right.length) / 2, tilting = left.bend_1 + right.bend_1;
  Vec6 unit;  // shift and tilt of unit energy: 8 EI / L and 24 EI / L^3 of beams of length L
  unit << Vec3::Constant(length / std::sqrt(3 * tilting)), Vec3::Constant(1 / std::sqrt(tilting));
  const Vec2 stretch(std::sqrt(left.axial * left.length), std::sqrt(right.axial * right.length));
  const Pose from = rod.poses()[node];
  Vec6 way = Vec6::Zero();
  ElementState a, b;
  for (int pass = 0; pass < 4; ++pass) {
    rod.element_state(node - 1, a);
    rod.element_state(node, b);
    const Vec9 ga = strain_gradient(left, a), gb = strain_gradient(right, b);
    Eigen::Matrix<Real, 2, 6> J;
    J << ga.head<3>().transpose(), ga.tail<3>().transpose(),  //
        -gb.head<3>().transpose(), gb.segment<3>(3).transpose();
    J = stretch.asDiagonal() * J * unit.asDiagonal();
    const Vec2 excess =
        stretch.cwiseProduct(Vec2(a.strain, b.strain) - Vec2::Constant(wholes_[node].strain));
    Eigen::Matrix<Real, 2, 2> jj = J * J.transpose();
    // A straight beam has one direction only, and nothing to correct across.
    jj.diagonal() = jj.diagonal() * (1 + 1e-9) + Vec2::Constant(softness);
    way = J.transpose() * (jj.inverse() * (J * way - excess));
    const Vec6 motion = unit.cwiseProduct(way);
    rod.poses()[node] = {from.position + motion.head<3>(),
                         rotated(from.rotation, motion.tail<3>())};
  }
}

/// Of the halves beside a node against the whole that they were (J).
Real Resampler::energy_change(const Rod& rod, Index node) const {
  Real sum = -wholes_[node].energy;
  ElementState s;
  for (const Index e : {node - 1, node}) {
    rod.element_state(e, s);
    sum += elastic_energy(rod.element(e), s);
  }
  return sum;
}

void Resampler::list_concerned(const Rod& rod) {
  concerned_.clear();
  for (Index k = 0; k < rod.nodes(); ++k)
    if (changed_[k]) concerned_.push_back(k);
  if (concerned_.empty() || concerned_.size() > 2) return;
  const Index a = concerned_.front(), b = concerned_.back();  // a rotation needs an arm
  if (a > 0) concerned_.insert(concerned_.begin(), a - 1);
  if (b + 1 < rod.nodes()) concerned_.push_back(b + 1);
}

/// What interpolation loses of momentum goes back as a rigid motion of the nodes concerned.
void Resampler::keep_momentum(Rod& rod, const Vec6& before) {
  list_concerned(rod);
  if (concerned_.empty()) return;
  Vec3 centre = Vec3::Zero();
  for (const Index k : concerned_)
    centre += rod.poses()[k].position / static_cast<Real>(concerned_.size());
  const auto add_motion = [&](const Vec3& v, const Vec3& w) {
    for (const Index k : concerned_) {
      rod.velocity().segment<3>(6 * k) += v + w.cross(rod.poses()[k].position - centre);
      rod.velocity().segment<3>(6 * k + 3) += w;
    }
  };
  const auto measure = [&] {  // about the centre
    Vec6 m;
    m.head<3>() = rod.momentum();
    m.tail<3>() = rod.angular_momentum() - centre.cross(Vec3(m.head<3>()));
    return m;
  };
  Vec6 missing = before;
  missing.tail<3>() -= centre.cross(Vec3(before.head<3>()));
  missing -= measure();
  // Momentum is linear in the motion: what each of six unit motions gives alone. Turns are per
  // `arm`, so that all are in one unit.
  const Real arm = rod.abscissa().back() / static_cast<Real>(rod.beams());
  Eigen::Matrix<Real, 6, 6> response;
  for (int c = 0; c < 6; ++c) {
    rod.velocity().setZero();
    add_motion(c < 3 ? Vec3(Vec3::Unit(c)) : Vec3::Zero(),
               c < 3 ? Vec3::Zero() : Vec3(Vec3::Unit(c - 3) / arm));
    response.col(c) = measure();
  }
  rod.velocity() = velocity_;
  response.bottomRows<3>() /= arm;
  missing.tail<3>() /= arm;
  const Vec6 x = response.colPivHouseholderQr().solve(missing);
  add_motion(x.head<3>(), x.tail<3>() / arm);
}

}  // namespace sutura::thread
