// The law against its definition, the staple against the balance of forces, and why its block has
// three rows and not one.
#include <gtest/gtest.h>

#include <random>

#include "staple_law.h"
#include "sutura/constraints.h"
#include "sutura/describe.h"
#include "sutura/laws/bilateral.h"
#include "sutura/simulation.h"

using namespace sutura;

// Whatever W and d: the answer lies on the graph of the law, and its tangent passes through it.
TEST(StapleLaw, AnswersLieOnItsGraph) {
  std::mt19937 random(1);
  std::normal_distribution<Real> normal;
  int taut = 0;
  for (int i = 0; i < 1000; ++i) {
    const StapleLaw::Params p{.stiffness = 50, .length = i % 2 ? 0.01 : 0, .pull_out = 1};
    const Mat3 root = Mat3::NullaryExpr([&] { return normal(random); });
    const Mat3 W = 0.1 * root * root.transpose() + 1e-4 * Mat3::Identity();
    const Vec3 d = 0.03 * Vec3::NullaryExpr([&] { return normal(random); });
    Mode mode = StapleLaw::slack;
    BlockVector<3> lambda(1, 2, 3);
    StapleLaw::project(W, d, p, mode, lambda);
    const Vec3 delta = W * lambda + d;
    const Real stretch = std::max(delta.norm() - p.length, Real(0));
    EXPECT_LT((lambda + p.stiffness * stretch * delta.normalized()).norm(), 1e-9);
    EXPECT_EQ(mode == StapleLaw::taut, d.norm() > p.length);
    if (stretch < 1e-3) continue;  // near slack, the tangent holds for a shorter way than below
    ++taut;
    FreeDirections<3> free;
    StapleLaw::free_directions(delta, p, mode, lambda, free);
    ASSERT_EQ(free.count, 3);
    const Vec3 moved = delta + 1e-7 * Vec3(1, -2, 3);
    const Vec3 force = -p.stiffness * (moved.norm() - p.length) * moved.normalized();
    const Vec3 miss = moved + free.gap + free.compliance * (force - lambda);
    EXPECT_LT(miss.norm(), 1e-3 * 1e-7 * 4);
  }
  EXPECT_GT(taut, 500);
}

// The same spring in one row, along the line between its two points as it is at the guess.
class OneRow : public Component, public ConstraintSource {
 public:
  static void describe(Describe<OneRow>& d) {
    d.summary("A two-point spring of one row.");
    d.link("thread", &OneRow::thread_, "Its end is tied.");
    d.link("tissue", &OneRow::tissue_, "To a point of this one.");
    d.attribute("point", &OneRow::point_, "m", any(), "The point.");
    d.attribute("stiffness", &OneRow::stiffness_, "N/m", above(0), "Force per stretch.");
  }
  void initialise(Setup& setup) override { source_id_ = setup.source_id; }
  void ready(Setup&) override {
    at_ = tissue_->closest_surface(point_, 1e-4, Configuration::rest)->at;
  }
  void build(const StepContext&, ConstraintBuilder& builder) override {
    const Vec3 end = thread_->point(thread_->length(), Configuration::current);
    const Vec3 anchor = tissue_->position(at_, Configuration::current);
    const Vec3 span = end - anchor;
    const Eigen::Matrix<Real, 1, 3> along = span.normalized().transpose();
    const BlockId block = builder.add<Bilateral<1>>(make_key(source_id_, 0), {1 / stiffness_},
                                                    BlockVector<1>(span.norm()));
    PointJacobian J;
    thread_->jacobian(thread_->length(), J);
    builder.couple(block, *thread_, along, J, end);
    tissue_->jacobian(at_, J);
    builder.couple(block, *tissue_, -along, J, anchor);
  }

 private:
  Link<CurveBody> thread_;
  Link<SolidBody> tissue_;
  Vec3 point_ = Vec3::Zero();
  Real stiffness_ = 1;
  Index source_id_ = 0;
  EmbeddedPoint at_;
};

class Staple : public testing::Test {
 protected:
  void load(std::unique_ptr<Scene> (*from)(const std::string&, Registry&, Diagnostics&),
            const std::string& text) {
    enrol_builtin(registry_);
    registry_.component<OneRow>("OneRow");
    Diagnostics diagnostics;
    auto scene = from(text, registry_, diagnostics);
    if (scene) simulation_ = Simulation::compile(std::move(scene), ".", diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    ASSERT_TRUE(simulation_);
  }
  static std::unique_ptr<Scene> file(const std::string& name, Registry& r, Diagnostics& d) {
    return load_scene(name, r, d, {.plugin_directories = {PLUGIN_DIR}});
  }
  static std::unique_ptr<Scene> text(const std::string& content, Registry& r, Diagnostics& d) {
    return load_scene_text(content, "test.xml", ".", r, d, {.plugin_directories = {PLUGIN_DIR}});
  }
  OutputValue output(const std::string& path, const std::string& name) const {
    const Component& c = *simulation_->find(path);
    for (const OutputInfo& o : c.info().outputs)
      if (o.name == name) return o.read(c);
    return "no output " + name;
  }

  Registry registry_;  // before what is made from it: it must live longer
  std::unique_ptr<Simulation> simulation_;
};

TEST_F(Staple, HoldsUntilItIsPulledOut) {
  load(file, SCENE);
  Real most = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(simulation_->step().solved);
    const Vec3 force = std::get<Vec3>(output("/staple", "force"));
    const Vec3 wall = std::get<Vec3>(output("/left/tissue", "reaction"));
    if (output("/staple", "state") == OutputValue("out")) break;
    // The left block hangs between its wall and the staple; its mass takes next to nothing.
    EXPECT_LT((force + wall).norm(), 1e-3);
    most = std::max(most, force.norm());
  }
  EXPECT_EQ(output("/staple", "state"), OutputValue("out"));
  EXPECT_LT(most, 0.2);
  EXPECT_GT(most, 0.19);  // the last step before: the hand moves on by 20 um a step
  EXPECT_EQ(std::get<Vec3>(output("/staple", "force")), Vec3::Zero());
}

/// A thread of 50 mm, clamped at its start, whose free end a spring of 10 N/m pulls to a point of a
/// block. What happens in 0.2 s after the end has arrived there.
struct Arrival {
  int unsolved = 0;
  Index passes = 0;
  Real path = 0;  ///< m
};

class FreeEnd : public Staple {
 protected:
  Arrival arrive(const std::string& spring) {
    load(text, R"(<sutura version="1" dt="10 ms">
      <plugin name="thread"/> <plugin name="tissue"/> <plugin name="hello_staple"/>
      <BlockMesh box="-5 -5 -10  5 5 0 mm" cells="3 3 3"/>
      <Tissue young="50 kPa" poisson="0.3" damping_stiffness="10 ms"/>
      <Attach box="-5 -5 -10  5 5 -10 mm"/>
      <SutureThread needle_length="0" thread="4-0 nylon" thread_length="50 mm" thread_beams="25"
                    tip="-40 0 10 mm" tip_direction="-1 0 0" clamp="start"/>)" +
                   spring + "</sutura>");
    Arrival out;
    if (!simulation_) return out;
    for (int i = 0; i < 50; ++i) simulation_->step();
    Vec3 before = end();
    for (int i = 0; i < 20; ++i) {
      const StepReport& report = simulation_->step();
      out.unsolved += !report.solved;
      out.passes += report.passes;
      out.path += (end() - before).norm();
      before = end();
    }
    return out;
  }
  Vec3 end() const { return std::get<Vec3>(output("/suture_thread", "end_position")); }
};

// One row knows the line of the spring as it was at the guess. The end of a thread weighs next to
// nothing: it swings far across that line before anything holds it, and the line turns with it.
TEST_F(FreeEnd, HardlyRestsOnOneRow) {
  const Arrival end = arrive("<OneRow stiffness='10'/>");
  EXPECT_GE(end.passes, 1000);
}

TEST_F(FreeEnd, RestsOnThree) {
  const Arrival end = arrive(
      "<Staple first='/suture_thread' first_point='10 0 10 mm' second='/tissue' stiffness='10'/>");
  EXPECT_EQ(end.unsolved, 0);
  EXPECT_LE(end.passes, 40);
  EXPECT_LT(end.path, 1e-6);
}
