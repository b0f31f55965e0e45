#include "runtime/better_guess.h"

#include <gtest/gtest.h>

namespace sutura {
namespace {

/// A body that is moved from outside alone.
class Point : public Body {
 public:
  explicit Point(Index dofs) : x(VecX::Zero(dofs)) {}
  VecX x;
  Index dofs() const override { return x.size(); }
  int width() const override { return kind; }
  int kind = 3;
  void motion(VecX& out) const override { out = x; }
  void move_to(const StepContext&, const VecX& motion) override { x = motion; }
  bool part_way = false;
  bool went_part_way() const override { return part_way; }
  void begin_step(const StepContext&) override {}
  void linearise(const StepContext&, const VecX&) override {}
  Eigen::Ref<const VecX> change() const override { return x; }
  void solve(Eigen::Ref<MatX>) const override {}
  void push(const StepContext&, const VecX&) override {}
  void correct(const StepContext&) override {}
  Imbalance imbalance(const StepContext&, const VecX&) override { return {}; }
  void end_step(const StepContext&, const VecX&) override {}
  Vec3 momentum() const override { return Vec3::Zero(); }
  Real mass() const override { return 0; }
  Real energy() const override { return 0; }
  bool finite() const override { return true; }
  BodyGeometry geometry() const override { return {}; }
};

/// Passes of x -> T (x - end) + end with T = Q diag(factors) Q^-1, and how far from its end the
/// last one leaves x.
Real left_after(int passes, const VecX& factors, bool with_help, int kind = 3) {
  const Index n = factors.size();
  Point point(n);
  point.kind = kind;
  std::vector<Simulation::NamedBody> bodies{{"point", &point}};
  BetterGuess better(bodies);
  better.forget();
  MatX q = MatX::Identity(n, n);
  for (Index i = 0; i + 1 < n; ++i) q(i, i + 1) = 0.3;
  const MatX T = q * factors.asDiagonal() * q.inverse();
  const VecX end = VecX::LinSpaced(n, 1, 2);
  const StepContext context{.dt = 0.01, .time = 0, .step = 0, .gravity = Vec3::Zero()};
  Real left = 0;
  std::vector<char> rests{0};
  for (int i = 0; i < passes; ++i) {
    better.begin_pass(rests);
    point.x = end + T * (point.x - end);
    left = (point.x - end).norm();
    if (with_help) better.move_on(context);
  }
  return left;
}

VecX factors(std::initializer_list<Real> slow) {
  VecX f = VecX::Zero(6);
  std::copy(slow.begin(), slow.end(), f.data());
  return f;
}

// With m slow directions and no others, m + 1 passes tell all there is to know; the first two go by
// without help.
TEST(BetterGuess, EndsWhatSwingsOrGrows) {
  for (const Real factor : {-1.0, -1.5, 0.9, 1.3}) {
    EXPECT_GT(left_after(5, factors({factor}), false), 0.1) << factor;
    EXPECT_LT(left_after(5, factors({factor}), true), 1e-9) << factor;
  }
  EXPECT_LT(left_after(7, factors({-0.95, 0.8}), true), 1e-7);
  EXPECT_LT(left_after(12, factors({-1.1, 0.9, -0.6}), true), 1e-5);
}

// Passes of a thread that grow lead away from a saddle. That is a balance too, but none to go back
// to.
TEST(BetterGuess, DoesNotTakePassesBackToASaddle) {
  for (const Real factor : {1.02, 1.3, 2.0})
    EXPECT_GT(left_after(6, factors({factor}), true, 6), left_after(3, factors({factor}), false, 6))
        << factor;
}

// They grow by little. Each of twelve but the first two goes twice as far.
TEST(BetterGuess, GoesAheadWherePassesLeadAwayFromASaddle) {
  for (const Real factor : {1.02, 1.07, 1.3})
    EXPECT_GT(left_after(12, factors({factor}), true, 6),
              left_after(16, factors({factor}), false, 6))
        << factor;
}

TEST(BetterGuess, LeavesGoodPassesAlone) {
  const VecX good = factors({0.2, -0.1});
  EXPECT_EQ(left_after(6, good, true), left_after(6, good, false));
}

// Passes that swing about the end, of which the first three are taken a tenth of the way.
TEST(BetterGuess, LearnsNothingFromAPassThatWasTakenPartOfTheWay) {
  Point point(3);
  point.x << 1, 2, 3;
  std::vector<Simulation::NamedBody> bodies{{"point", &point}};
  BetterGuess better(bodies);
  const StepContext context{.dt = 0.01, .time = 0, .step = 0, .gravity = Vec3::Zero()};
  const VecX end = VecX::Ones(3);
  std::vector<char> rests{0};
  for (int i = 0; i < 6; ++i) {
    better.begin_pass(rests);
    point.part_way = i < 3;
    point.x += (point.part_way ? 0.1 : 1) * 2 * (end - point.x);
    const bool moved = better.move_on(context);
    EXPECT_EQ(moved, i >= 4) << i;
  }
  EXPECT_LT((point.x - end).norm(), 1e-12);
}

TEST(BetterGuess, ABodyThatRestsIsNotMoved) {
  Point moves(3), rests(3);
  rests.x << 1, 2, 3;
  std::vector<Simulation::NamedBody> bodies{{"moves", &moves}, {"rests", &rests}};
  BetterGuess better(bodies);
  const StepContext context{.dt = 0.01, .time = 0, .step = 0, .gravity = Vec3::Zero()};
  const VecX before = rests.x;
  bool moved = false;
  std::vector<char> rest{0, 1};
  for (int i = 0; i < 4; ++i) {
    better.begin_pass(rest);
    moves.x = -moves.x + VecX::Ones(3);
    moved = better.move_on(context) || moved;
  }
  EXPECT_TRUE(moved);
  EXPECT_EQ(rests.x, before);
  EXPECT_LT((moves.x - VecX::Constant(3, 0.5)).norm(), 1e-12);
}

TEST(BetterGuess, ABodyThatHasToMoveAgainRestsNoMore) {
  Point first(3), second(3);
  std::vector<Simulation::NamedBody> bodies{{"first", &first}, {"second", &second}};
  BetterGuess better(bodies);
  // What the balance would let rest, pass by pass, and what does.
  const std::vector<std::vector<char>> may{{0, 1}, {1, 0}, {1, 1}, {0, 1}, {1, 1}};
  const std::vector<std::vector<char>> does{{0, 1}, {1, 0}, {1, 0}, {0, 0}, {0, 0}};
  for (int step = 0; step < 2; ++step) {
    better.forget();
    for (std::size_t i = 0; i < may.size(); ++i) {
      std::vector<char> rests = may[i];
      better.begin_pass(rests);
      EXPECT_EQ(rests, does[i]) << step << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace sutura
