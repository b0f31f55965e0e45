// a05a: critical loads. The static tangent is positive definite below the load and not above.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reference_table.h"
#include "rod_static.h"
#include "unit/thread/rod_builder.h"

namespace sutura::thread {
namespace {

constexpr Real length = 0.1;

Real reference(const std::string& start) {
  const ReferenceTable table("a05a_critical_loads.csv");
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.text(i, "case").starts_with(start)) return table.number(i, "value");
  ADD_FAILURE() << "no case " << start;
  return 0;
}

using Fix = std::function<void(BlockTridiagonal&, Index last)>;
void fix(BlockTridiagonal& m, Index node, std::initializer_list<int> dofs) {
  for (const int d : dofs) m.fix(node, d);
}

/// Is the straight rod under the axial end load P stable?
bool column_stable(Real load, const Fix& ends) {
  const Section s = nylon();
  constexpr Index beams = 20;
  Rod rod;
  rod.build(straight_layout(length, beams, s));
  const Real shortening = load * s.bending_stiffness() / (length * length) / s.axial_stiffness();
  for (Pose& p : rod.poses()) p.position *= 1 - shortening;
  BlockTridiagonal tangent;
  assemble_static(rod, Vec3::Zero(), tangent);
  ends(tangent, beams);
  return tangent.factor();
}

TEST(CriticalLoad, EulerColumns) {
  const auto clamp = {0, 1, 2, 3, 4, 5};
  const std::pair<const char*, Fix> cases[] = {
      {"Euler clamped-free", [&](BlockTridiagonal& m, Index) { fix(m, 0, clamp); }},
      {"Euler pinned-pinned",
       [](BlockTridiagonal& m, Index last) {
         fix(m, 0, {0, 1, 2, 3});
         fix(m, last, {1, 2});
       }},
      {"Euler clamped-pinned",
       [&](BlockTridiagonal& m, Index last) {
         fix(m, 0, clamp);
         fix(m, last, {1, 2});
       }},
      {"Euler clamped-clamped", [&](BlockTridiagonal& m, Index last) {
         fix(m, 0, clamp);
         fix(m, last, {1, 2, 3, 4, 5});
       }}};
  for (const auto& [name, ends] : cases) {
    const Real critical = reference(name);
    // Asked: 1 %. 20 cubic beams are exact to 1e-6, the shortening before buckling adds 1e-4.
    EXPECT_TRUE(column_stable(0.998 * critical, ends)) << name;
    EXPECT_FALSE(column_stable(1.002 * critical, ends)) << name;
  }
}

TEST(CriticalLoad, UprightUnderItsWeight) {
  const Real critical = reference("self-weight");
  for (const Real factor : {0.995, 1.005}) {
    const Section s = nylon();
    const Real g =
        factor * critical * s.bending_stiffness() / (s.density * s.area() * std::pow(length, 3));
    Rod rod;
    rod.build(straight_layout(length, 20, s, Vec3::UnitZ()));
    rod.clamp(0);
    const Real weight = s.density * s.area() * length * g;
    EXPECT_TRUE(equilibrium(rod, Vec3(0, 0, -g), VecX::Zero(rod.dofs()), 1e-8 * weight).converged);
    BlockTridiagonal tangent;
    assemble_static(rod, Vec3(0, 0, -g), tangent);
    EXPECT_EQ(tangent.factor(), factor < 1) << factor;
  }
}

/// A straight rod closed to a ring and glued after a twist: does it stay flat? A clamp at the joint
/// takes away the rigid motions. (A round rod keeps one neutral motion, the ring turning about the
/// clamp's tangent while its sections roll, so the sign of the tangent alone does not tell.)
bool ring_stays_flat(const Section& s, Index beams, Real total_twist) {
  RodLayout layout = straight_layout(length, beams, s);
  const Real radius = length / (2 * std::numbers::pi);
  for (Index i = 0; i <= beams; ++i) {
    const Real u = static_cast<Real>(i) / static_cast<Real>(beams), a = 2 * std::numbers::pi * u;
    layout.start[i].position = radius * Vec3(std::sin(a), 1 - std::cos(a), 0);
    layout.start[i].rotation = Quat(Eigen::AngleAxis<Real>(a, Vec3::UnitZ())) *
                               Quat(Eigen::AngleAxis<Real>(total_twist * u, Vec3::UnitX()));
  }
  Rod rod;
  rod.build(layout);
  for (Real& t : rod.twist()) t = total_twist / static_cast<Real>(beams);
  rod.clamp(0);
  rod.clamp(beams);
  const Real force = s.bending_stiffness() / (length * length);
  EXPECT_TRUE(equilibrium(rod, Vec3::Zero(), VecX::Zero(rod.dofs()), 1e-5 * force, 300).converged);
  return std::abs(rod.poses(Configuration::current)[beams / 2].position.z()) < 1e-3 * radius;
}

TEST(CriticalLoad, MichellRing) {
  for (const Real poisson : {0.3, 0.5}) {
    Section s = nylon();
    s.poisson = poisson;
    s.radius /= 10;  // inextensible against EI
    s.young *= 1e4;
    const Real critical = reference(poisson == 0.3 ? "Michell ring nu=0.3" : "Michell ring nu=0.5");
    // Asked: 1 %. (Straight beams would buckle late by 33/N^2 = 1.4 % here.)
    EXPECT_TRUE(ring_stays_flat(s, 48, 0.99 * critical)) << poisson;
    EXPECT_FALSE(ring_stays_flat(s, 48, 1.01 * critical)) << poisson;
  }
}

}  // namespace
}  // namespace sutura::thread
