// A thread round a bar: reference a11a.
//
// The reference is a string without thickness. A thread has its tension at R + r from the axis of
// the bar and rubs at R; the friction also turns its sections, which takes a shear force. Balance
// of force and moment along the thread then give T ~ exp(a phi) with
//   a (1 + q mu a) = mu (1 - q),     q = r / (R + r)          (docs/theory/contact.md).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "csv.h"
#include "scenes/text_run.h"

namespace sutura::testing {
namespace {

struct Capstan {
  Real mu = 0.3, wrap = 2 * std::numbers::pi;
  Real bar = 3e-3, radius = 0.0875e-3;
  Real turn = 0.17;     ///< of a beam (rad)
  Real tension = 0.02;  ///< at the slack end (N)
  Real speed = 4e-3;    ///< of the hand (m/s)
  Real pull = 0;        ///< a weight instead of the hand (N)
  Real bending = 0.01;  ///< bending_factor
  Real spin = 0;        ///< of the bar, against the hand (rad/s)
  int corners = 0;      ///< a bar with so many, as a mesh; 0: a round one
};

/// A prism about the z axis whose corners are `radius` (m) away from it, as OBJ.
std::string prism_file(int corners, Real radius) {
  const std::string file = SUTURA_BINARY_DIR "/prism_" + std::to_string(corners) + ".obj";
  std::ofstream out(file);
  out << std::setprecision(17);
  for (const Real z : {-0.03, 0.03})
    for (int k = 0; k < corners; ++k) {
      const Real angle = 2 * std::numbers::pi * k / corners;
      out << "v " << radius * std::cos(angle) << ' ' << radius * std::sin(angle) << ' ' << z
          << '\n';
    }
  for (int k = 1; k <= corners; ++k) {
    const int next = k % corners + 1;
    out << "f " << k << ' ' << next << ' ' << next + corners << ' ' << k + corners << '\n';
  }
  for (const int from : {0, corners}) {
    out << 'f';
    for (int k = 1; k <= corners; ++k) out << ' ' << from + (from > 0 ? k : corners + 1 - k);
    out << '\n';
  }
  return file;
}

/// A thread with straight ends of 10 mm, wound round the bar as a helix whose turns do not meet.
TextRun wound(const Capstan& c) {
  const Real tail = 10e-3, around = c.bar + c.radius;
  const Real rise = c.wrap > 4.7 ? 6 * c.radius / (2 * std::numbers::pi) : 0;
  const Real square = around * around + rise * rise;
  const Real curvature = around / square, torsion = rise / square, length = c.wrap / curvature;
  // A file for each test, as tests run beside each other.
  const std::string name = std::string(SUTURA_BINARY_DIR "/capstan_") +
                           ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::ofstream(name) << std::setprecision(17) << "s [m],curvature [1/m],torsion [1/m]\n0,0,0\n"
                      << tail << ',' << curvature << ',' << torsion << '\n'
                      << tail + length << ",0,0\n";
  // The thread comes along x and bends towards -y.
  const Vec3 axis = Vec3(torsion, 0, -curvature).normalized();
  const Real angle = std::hypot(curvature, torsion) * length;
  const Vec3 end = Eigen::AngleAxis<Real>(angle, axis) * Vec3::UnitX();
  std::ostringstream s;
  s << std::setprecision(17);
  const auto vector = [&](const Vec3& v) {
    std::ostringstream text;
    text << std::setprecision(17) << v.x() << ' ' << v.y() << ' ' << v.z();
    return text.str();
  };
  const Real total = 2 * tail + length;
  s << "<plugin name='contact'/><SutureThread name='suture' needle_length='0' "
       "thread='4-0 polypropylene' bending_factor='"
    << c.bending << "' damping_stiffness='0.1 ms' tip_direction='-1 0 0' thread_start_file='"
    << name << "' thread_diameter='" << 2 * c.radius << "' thread_length='" << total
    << "' thread_beams='" << std::lround(total * curvature / c.turn) << "'/>"
    << "<Tool name='bar' "
    << (c.corners > 0 ? "shape='mesh' file='" + prism_file(c.corners, c.bar)
                      : "shape='cylinder' length='60 mm' radius='" + std::to_string(c.bar))
    << "' centre='" << vector(Vec3(tail, -around, 0)) << "' axis='" << vector(axis)
    << "' motion='drum'/>"
    << "<Track name='drum' centre='" << vector(Vec3(tail, -around, 0))
    << "' times='0 10 s' rotations='0 0 0 " << vector(10 * c.spin * axis) << "'/>"
    << "<Contact tool='bar' friction='" << c.mu << "'/><ThreadLoad at='" << total << "' force='"
    << vector(c.tension * end) << "' times='0 0.05 s' factors='0 1'/>"
    << "<Track name='hand' times='0 0.1 10.1 s' positions='0 0 0 0 0 0 " << -10 * c.speed
    << " 0 0'/>";
  if (c.pull > 0)
    s << "<ThreadLoad name='heavy' at='0' force='" << -c.pull
      << " 0 0' times='0 0.05 s' factors='0 1'/>";
  else
    s << "<Grasper at='0' track='hand' rotation_stiffness='0'/>";
  return TextRun(s.str(), "dt='10 ms' gravity='0 0 0' tolerance='1e-3'");
}

/// Ratio of the two tensions, once the thread slides all round.
Real ratio(const Capstan& c, Real seconds = 0.6) {
  TextRun run = wound(c);
  EXPECT_TRUE(run) << run.said();
  if (!run) return 0;
  while (run.simulation().time() < seconds) {
    const StepReport& report = run.simulation().step();
    EXPECT_TRUE(report.solved) << report.time;
    EXPECT_TRUE(report.faults.empty());
    EXPECT_LT(report.passes, 40) << report.time;
  }
  EXPECT_GT(run.number("/contact", "distance"), -0.06 * c.radius);
  return run.vector("/grasper", "force").norm() / c.tension;
}

Real thick(const Capstan& c) {
  const Real q = c.radius / (c.bar + c.radius);
  const Real a = (std::sqrt(1 + 4 * q * c.mu * c.mu * (1 - q)) - 1) / (2 * q * c.mu);
  return std::exp(a * c.wrap);
}

TEST(Capstan, HoldsWithTheExponentialOfTheAngle) {
  const Table reference = read_csv(SUTURA_SOURCE_DIR "/tests/reference/a11a_capstan.csv");
  for (std::size_t i = 0; i < reference.rows.size(); ++i) {
    Capstan c{.mu = reference.number(i, "mu"),
              .wrap = reference.number(i, "wrap deg") * std::numbers::pi / 180};
    // Beyond, the pulled end needs more than the thread bears.
    if (reference.number(i, "exp(mu phi)") > 50) continue;
    EXPECT_NEAR(reference.number(i, "exp(mu phi)"), std::exp(c.mu * c.wrap), 1e-6);
    EXPECT_NEAR(ratio(c) / thick(c), 1, 0.01) << c.mu << ' ' << c.wrap;
  }
}

// A bar with corners, without friction: the thread slides over them with the force that it has.
// Where it touches at the same places of its own until others are nearer by much, it is pushed on
// by the sides that these have got to: with a twentieth of its radius the hand felt 17 % less.
TEST(Capstan, CornersTakeNothingAndGiveNothing) {
  for (const int corners : {12, 24, 48}) {
    const Capstan c{.mu = 0, .wrap = std::numbers::pi, .corners = corners};
    TextRun run = wound(c);
    ASSERT_TRUE(run) << run.said();
    Real sum = 0, steps = 0;
    while (run.simulation().time() < 0.8) {
      const StepReport& report = run.simulation().step();
      EXPECT_TRUE(report.solved && report.faults.empty()) << report.time;
      if (report.time < 0.2) continue;
      sum += run.vector("/grasper", "force").norm();
      ++steps;
    }
    EXPECT_NEAR(sum / steps / c.tension, 1, 0.02) << corners;
  }
}

// The same bar and a thread as fine as a hair: the string of the reference itself.
TEST(Capstan, AFineThreadIsTheStringOfTheReference) {
  const Capstan c{.mu = 0.2, .bar = 6e-3, .radius = 30e-6, .tension = 2e-3};
  EXPECT_NEAR(ratio(c) / std::exp(c.mu * c.wrap), 1, 0.02);
}

// The hand rests and the bar turns below the thread, by up to 0.8 rad in a step: the same.
TEST(Capstan, ABarThatTurnsPullsAsAHandDoes) {
  for (const Real spin : {4., 80.}) {
    const Capstan c{.mu = 0.2, .speed = 0, .spin = spin};
    EXPECT_NEAR(ratio(c) / thick(c), 1, 0.01) << spin;
  }
}

/// Force of the hand on a thread that has bending stiffness, over that of the weight, for forces
/// that turn by `wrap` from one to the other.
///
/// Where it lies on the bar it has the curvature 1 / rho and so a moment that does not change:
/// there it is a string, T ~ exp(a phi). Outside it is an elastica that ends in the direction of
/// the force F, and as its curvature does not jump it leaves the bar at an angle theta to that,
///   1 - cos theta = EI / (2 F rho^2).
/// Its shear F sin theta ends where it meets the bar, less r f that friction asks for inside: this
/// is a force N on a point, which rubs as well. The couple of that point, r mu N, is left out.
Real stiff(const Capstan& c) {
  const Real rho = c.bar + c.radius, q = c.radius / rho;
  const Real EI = c.bending * 1.5e9 * std::numbers::pi / 4 * std::pow(c.radius, 4);
  const Real a = (std::sqrt(1 + 4 * q * c.mu * c.mu * (1 - q)) - 1) / (2 * q * c.mu);
  const auto leaves_at = [&](Real F) { return std::acos(1 - EI / (2 * F * rho * rho)); };
  // Inside beside the end at which the force is F: T = F cos theta + sign mu N, with
  // N = F sin theta - sign r f and f = a T / ((1 - q) rho).
  const auto inside = [&](Real F, int sign) {
    const Real theta = leaves_at(F);
    return F * (std::cos(theta) + sign * c.mu * std::sin(theta)) / (1 + c.mu * q * a / (1 - q));
  };
  Real low = c.tension, high = c.tension * std::exp(c.mu * c.wrap);
  for (int i = 0; i < 60; ++i) {
    const Real F = (low + high) / 2;
    const Real touched = c.wrap - leaves_at(c.tension) - leaves_at(F);
    (inside(F, -1) < inside(c.tension, 1) * std::exp(a * touched) ? low : high) = F;
  }
  return low / c.tension;
}

TEST(Capstan, AThreadWithBendingStiffnessHoldsLess) {
  for (const Real mu : {0.15, 0.3}) {
    Capstan c{.mu = mu, .wrap = std::numbers::pi, .turn = 0.08, .bending = 1};
    TextRun run = wound(c);
    ASSERT_TRUE(run) << run.said();
    while (run.simulation().time() < 0.6) EXPECT_TRUE(run.simulation().step().solved);
    const Vec3 hand = run.vector("/grasper", "force");
    // The hand is a point that does not go aside, so its force leans by some degrees.
    c.wrap -= std::atan2(hand.y(), -hand.x());
    // The couple that is left out is a share of mu r / rho.
    EXPECT_NEAR(hand.norm() / c.tension / stiff(c), 1, 0.015) << mu;
    EXPECT_LT(stiff(c), 0.96 * thick(c));  // without bending stiffness it would be this
  }
}

// Two weights: below the threshold nothing moves, above it the thread runs to the heavier one.
TEST(Capstan, SticksBelowTheThresholdAndSlidesAbove) {
  Capstan c{.mu = 0.3, .wrap = std::numbers::pi};
  for (const Real share : {0.98, 1.02}) {
    c.pull = share * thick(c) * c.tension;
    TextRun run = wound(c);
    ASSERT_TRUE(run) << run.said();
    if (share < 1) {
      run.run(0.1);
      const Vec3 at = run.vector("/suture", "tip_position");
      run.run(0.2);
      EXPECT_LT((run.vector("/suture", "tip_position") - at).norm(), 1e-9);
    } else {
      // The tip begins at the origin; a thread so light has run off the bar soon after.
      run.run(0.07);
      EXPECT_GT(run.vector("/suture", "tip_position").norm(), 1e-3);
      EXPECT_LT(run.vector("/suture", "tip_position").x(), 0);
    }
  }
}

}  // namespace
}  // namespace sutura::testing
