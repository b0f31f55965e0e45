// The twins of the laws answer as the laws do: 1e5 random blocks each.
#include <Eigen/Eigenvalues>
#include <bit>
#include <random>

#include "../../../plugins/suturing/cutting_law.h"
#include "../../../plugins/suturing/path_friction_law.h"
#include "../../../plugins/suturing/puncture_law.h"
#include "law_twins.h"
#include "program.h"
#include "programs.h"
#include "solve_problems.h"
#include "some_device.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/static_friction.h"
#include "sutura/laws/turning_force.h"
#include "sutura/laws/unilateral.h"

namespace sutura::opencl {
namespace {

constexpr int draws = 100000;

// Blocks one after the other, D x D by columns.
const char* const kernel_text = R"(
kernel void ask(int blocks, int law, int parameters, global const real* W, global const real* d,
                global const real* p, global uchar* modes, global real* lambda) {
  const int b = get_global_id(0);
  if (b >= blocks) return;
  real own[D * D], inverse[D * D], mine[D], out[D];
  for (int e = 0; e < D * D; ++e) own[e] = W[b * D * D + e];
  for (int i = 0; i < D; ++i) mine[i] = d[b * D + i];
  invert_with_compliance(law, D, own, p + b * parameters, inverse);
  uchar mode = modes[b];
  for (int i = 0; i < D; ++i) out[i] = 0;
  project(law, own, inverse, mine, p + b * parameters, &mode, out);
  modes[b] = mode;
  for (int i = 0; i < D; ++i) lambda[b * D + i] = out[i];
}
)";

using Random = std::mt19937_64;

Real from(Random& random, Real low, Real high) {
  return std::uniform_real_distribution<Real>(low, high)(random);
}
bool one_in(Random& random, int n) {
  return random() % static_cast<unsigned>(n) == 0;
}
Vec3 direction(Random& random) {
  std::normal_distribution<Real> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

template <int N>
typename Bilateral<N>::Params draw(Random& random, const Bilateral<N>*) {
  typename Bilateral<N>::Params p;
  if (one_in(random, 2)) p.compliance = from(random, 0, 2);
  if (one_in(random, 2)) p.cap = from(random, 0.01, 1);
  return p;
}
Unilateral::Params draw(Random& random, const Unilateral*) {
  return {.compliance = from(random, 0, 2)};
}
Coulomb::Params draw(Random& random, const Coulomb*) {
  return {.mu = one_in(random, 10) ? 0 : from(random, 0, 1.5),
          .compliance = one_in(random, 2) ? 0 : from(random, 0, 2)};
}
StaticFriction::Params draw(Random& random, const StaticFriction*) {
  const Real mu = from(random, 0, 1.5);
  return {.mu_static = mu,
          .mu_kinetic = mu * from(random, 0.3, 1),
          .compliance = one_in(random, 2) ? 0 : from(random, 0, 2),
          .stick_slip = from(random, 0, 1)};
}
suturing::PunctureLaw::Params draw(Random& random, const suturing::PunctureLaw*) {
  suturing::PunctureLaw::Params p;
  p.normal = direction(random);
  p.axis = direction(random);
  p.puncture_force = from(random, 0.1, 1);
  p.cutting_force = from(random, 0, 0.5);
  p.friction = from(random, 0, 1);
  p.compliance = one_in(random, 2) ? 0 : from(random, 0, 2);
  p.drag = one_in(random, 2) ? 0 : from(random, 0, 5);
  p.hold = one_in(random, 2);
  return p;
}
suturing::CuttingLaw::Params draw(Random& random, const suturing::CuttingLaw*) {
  return {.threshold = from(random, 0, 1)};
}
suturing::PathFrictionLaw::Params draw(Random& random, const suturing::PathFrictionLaw*) {
  const Real level = from(random, 0, 1);
  return {.static_level = level,
          .kinetic = level * from(random, 0.3, 1),
          .viscous = one_in(random, 2) ? 0 : from(random, 0, 5),
          .stick_slip = from(random, 0, 1)};
}

/// As stiff as it takes for its system to be far from singular.
TurningForce::Params draw(Random& random, const TurningForce*) {
  const Real c = from(random, 0.1, 1);
  return {.stiffness = from(random, 100, 200) * c * c, .coupling = c};
}

template <class L>
class Twin : public OnDevice {};

using Laws = testing::Types<Bilateral<1>, Bilateral<2>, Bilateral<3>, Bilateral<6>, Unilateral,
                            Coulomb, StaticFriction, suturing::PunctureLaw, suturing::CuttingLaw,
                            suturing::PathFrictionLaw, TurningForce>;
TYPED_TEST_SUITE(Twin, Laws);

TYPED_TEST(Twin, AnswersAsTheLaw) {
  using L = TypeParam;
  constexpr int n = L::dim;
  const LawTwin* twin = find_twin(law_operations<L>);
  ASSERT_NE(twin, nullptr);
  const Device& device = *this->device_;
  if (!device.has_double()) GTEST_SKIP() << "no double precision";

  Random random(7);
  std::vector<double> W, d, p;
  std::vector<cl_uchar> modes;
  std::vector<typename L::Params> params;
  for (int i = 0; i < draws; ++i) {
    const BlockMatrix<n> block = test::random_spd<n>(random);
    W.insert(W.end(), block.data(), block.data() + n * n);
    for (int k = 0; k < n; ++k) d.push_back(from(random, -1, 1));
    params.push_back(draw(random, static_cast<const L*>(nullptr)));
    Real numbers[LawTwin::most_parameters];
    read_parameters(*twin, &params.back(), numbers);
    p.insert(p.end(), numbers, numbers + twin->parameters());
    const Mode other = std::is_same_v<L, StaticFriction> ? StaticFriction::sliding : Mode(1);
    modes.push_back(one_in(random, 2) ? other : Mode(0));
  }
  std::vector<cl_uchar> answered = modes;
  std::vector<double> lambda(d.size());
  Program program(device, Precision::double_, std::string(programs::laws) + kernel_text,
                  "-DPARAMETERS=global -DD=" + std::to_string(n));
  Buffer W_there(device), d_there(device), p_there(device), modes_there(device),
      lambda_there(device);
  W_there.write(W);
  d_there.write(d);
  p_there.write(p);
  modes_there.write(answered);
  lambda_there.write(lambda);
  program["ask"](draws, 64, draws, twin->number, twin->parameters(), W_there, d_there, p_there,
                 modes_there, lambda_there);
  modes_there.read(answered);
  lambda_there.read(lambda);

  int other_modes = 0, states = 0;
  Real worst = 0;
  for (int i = 0; i < draws; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const BlockMatrix<n> block = Eigen::Map<const BlockMatrix<n>>(&W[at * n * n]);
    const BlockVector<n> free = Eigen::Map<const BlockVector<n>>(&d[at * n]);
    const BlockVector<n> theirs = Eigen::Map<const BlockVector<n>>(&lambda[at * n]);
    BlockVector<n> ours = BlockVector<n>::Zero();
    Mode mode = modes[at];
    L::project(block, free, params[at], mode, ours);
    states |= 1 << mode;
    if (mode != answered[at]) ++other_modes;
    ASSERT_TRUE(theirs.allFinite()) << i;
    // As rounding is amplified: by the condition of the block.
    const Eigen::SelfAdjointEigenSolver<BlockMatrix<n>> eigen(block);
    const Real condition = eigen.eigenvalues()[n - 1] / eigen.eigenvalues()[0];
    worst = std::max(worst, (ours - theirs).norm() / (condition * (ours.norm() + 1e-3)));
  }
  // Rounding is 1e-16; roots are found to some of it, in a system that couples three rows.
  EXPECT_LT(worst, 1e-13);
  // Within rounding of the border between two modes either answer is right.
  EXPECT_LE(other_modes, 2);
  EXPECT_GE(std::popcount(static_cast<unsigned>(states)), 1 + (n < 6 ? 0 : 1))
      << "the draws meet one state only";
  std::printf("  %s: worst %.1e of its condition, %d other modes, states %x\n", L::name, worst,
              other_modes, static_cast<unsigned>(states));
}

}  // namespace
}  // namespace sutura::opencl
