// A component that throws in the middle of a step ends the simulation and is named, with the stage
// and its line in the scene; so is one that makes more rows than a step may hold.
#include <filesystem>
#include <new>
#include <stdexcept>

#include "runtime/failure.h"
#include "sutura/archive.h"
#include "sutura/run.h"
#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

/// Throws in the function that the scene names, from the second step on.
class Bomb {
 public:
  std::string in;

 protected:
  void pass_by_archive(Archive& a) const {
    if (in == (a.restoring() ? "restore" : "save")) throw std::runtime_error("boom");
  }
  void pass_by(const std::string& where, Index step = 1) const {
    if (where != in || step < 1) return;
    if (where == "detect") throw std::bad_alloc();
    throw std::runtime_error("boom");
  }
};

class BombMass : public Mass, public Bomb {
 public:
  static void describe(Describe<BombMass>& d) {
    d.summary("Throws.");
    d.attribute("in", static_cast<std::string BombMass::*>(&Bomb::in), "Where.");
    d.output("bang", "N", "Throws.",
             [](const BombMass&) -> Real { throw std::runtime_error("boom"); });
  }
  void begin_step(const StepContext& c) override {
    pass_by("begin_step", c.step);
    Mass::begin_step(c);
  }
  void linearise(const StepContext& c, const VecX& force) override {
    pass_by("linearise", c.step);
    Mass::linearise(c, force);
  }
  void add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const override {
    pass_by("add_compliance", step);
    Mass::add_compliance(rows, dt, W);
  }
  void push(const StepContext& c, const VecX& change) override {
    pass_by("push", c.step);
    Mass::push(c, change);
  }
  void correct(const StepContext& c) override {
    pass_by("correct", c.step);
    Mass::correct(c);
  }
  Imbalance imbalance(const StepContext& c, const VecX& force) override {
    pass_by("imbalance", c.step);
    return Mass::imbalance(c, force);
  }
  void end_step(const StepContext& c, const VecX& force) override {
    pass_by("end_step", c.step);
    Mass::end_step(c, force);
  }
};

class BombPin : public Pin, public Bomb {
 public:
  Index blocks = 0;  ///< besides that of the pin
  static void describe(Describe<BombPin>& d) {
    d.summary("Throws.");
    d.link("mass", static_cast<Link<Mass> BombPin::*>(&Pin::mass), "What it holds.");
    d.attribute("in", static_cast<std::string BombPin::*>(&Bomb::in), "Where.");
    d.attribute("blocks", &BombPin::blocks, at_least(0), "More blocks.");
  }
  const char* rows_attribute() const override { return "blocks"; }
  void detect(const StepContext& c) override { pass_by("detect", c.step); }
  void build(const StepContext& c, ConstraintBuilder& builder) override {
    pass_by("build", c.step);
    Pin::build(c, builder);
    for (Index i = 0; i < blocks; ++i)
      builder.add<Bilateral<3>>(make_key(id, static_cast<std::uint64_t>(i) + 1), {},
                                BlockVector<3>::Zero());
    if (in == "gap" && c.step >= 1)
      builder.add<Bilateral<3>>(make_key(id, 1), {},
                                BlockVector<3>::Constant(std::numeric_limits<Real>::quiet_NaN()));
  }
  void commit(const StepContext& c, const SolvedBlocks& solved) override {
    pass_by("commit", c.step);
    Pin::commit(c, solved);
  }
};

class BombClock : public Component, public Driver, public Bomb {
 public:
  static void describe(Describe<BombClock>& d) {
    d.summary("Throws.");
    d.attribute("in", static_cast<std::string BombClock::*>(&Bomb::in), "Where.");
  }
  void drive(const StepContext& c) override { pass_by("drive", c.step); }
  Real next_event(Real time) const override {
    pass_by("next_event", time > 0.1 ? 1 : 0);  // not in the first step of 0.1 s
    return Driver::next_event(time);
  }
  void archive(Archive& a) override { pass_by_archive(a); }
};

class BombNotes : public Notes, public Bomb {
 public:
  static void describe(Describe<BombNotes>& d) {
    d.summary("Throws.");
    d.attribute("in", static_cast<std::string BombNotes::*>(&Bomb::in), "Where.");
  }
  std::string start(const Simulation&) override {
    pass_by("start");
    return {};
  }
  std::string record(const Simulation& s, const StepReport& report) override {
    pass_by("record", report.step - 1);
    std::string error;
    if (in == "reads" && report.step == 2) s.scene().output("/b.bang", error).read();
    return {};
  }
  std::string finish(const Simulation& s) override {
    pass_by("finish");
    return Notes::finish(s);
  }
};

class BombSolver : public Component, public ConstraintSolver, public Bomb {
 public:
  static void describe(Describe<BombSolver>& d) { d.summary("Throws."); }
  SolveReport solve(ConstraintProblem&) override { throw std::runtime_error("boom"); }
};

void enrol(Registry& r) {
  r.begin_plugin("fireworks");
  r.component<BombMass>("BombMass");
  r.component<BombPin>("BombPin");
  r.component<BombClock>("BombClock");
  r.component<BombNotes>("BombNotes");
  r.component<BombSolver>("BombSolver");
  r.end_plugin();
}

/// The failure of the second step; the first one is as good as any.
std::string failure(const std::string& elements) {
  const World w("<plugin name='fireworks'/>\n" + elements, enrol);
  EXPECT_TRUE(w.simulation) << w.messages();
  if (!w.simulation) return {};
  EXPECT_EQ(w.simulation->start_recording(), "");
  EXPECT_FALSE(w.simulation->step().failure);
  const StepReport& report = w.simulation->step();
  EXPECT_TRUE(report.failure);
  const Index calls = static_cast<Index>(log().size());
  w.simulation->step();
  EXPECT_EQ(static_cast<Index>(log().size()), calls) << "a failed simulation goes on";
  return report.failure ? report.failure->text() : "";
}

std::string boom(const std::string& component, const std::string& stage) {
  return "test.xml:2: error: [/b] " + component + " failed in stage '" + stage +
         "' of step 2: boom (a fault in the plugin 'fireworks', not in the scene: please report "
         "it)";
}

TEST(AThrowInAStep, NamesTheBodyAndTheStage) {
  const auto body = [](const std::string& in) {
    return failure("<BombMass name='b' in='" + in + "'/><Pin name='p'/>");
  };
  EXPECT_EQ(body("begin_step"), boom("BombMass", "inputs"));
  EXPECT_EQ(body("linearise"), boom("BombMass", "linearise"));
  EXPECT_EQ(body("add_compliance"), boom("BombMass", "compliance"));
  EXPECT_EQ(body("correct"), boom("BombMass", "correct"));
  EXPECT_EQ(body("imbalance"), boom("BombMass", "measure"));
  EXPECT_EQ(body("end_step"), boom("BombMass", "commit"));
}

TEST(AThrowInAStep, NamesTheSource) {
  const auto pin = [](const std::string& in) {
    return failure("<BombPin name='b' in='" + in + "'/><Mass name='m'/>");
  };
  EXPECT_EQ(pin("build"), boom("BombPin", "build"));
  EXPECT_EQ(pin("commit"), boom("BombPin", "commit"));
  EXPECT_EQ(pin("detect"),
            "test.xml:2: error: [/b] BombPin asks for more memory than there is, in stage 'detect' "
            "of step 2");
}

TEST(AGapThatIsNoNumber, NamesTheSourceThatMadeIt) {
  EXPECT_EQ(
      failure("<BombPin name='b' in='gap' mass='/m'/><Pin name='p' mass='/m'/><Mass name='m'/>"),
      "test.xml:2: error: [/b] BombPin failed in stage 'build' of step 2: the gap of a row is "
      "not a finite number (a fault in the plugin 'fireworks', not in the scene: please "
      "report it)");
}

TEST(AThrowInAStep, NamesTheDriverAndTheRecorder) {
  EXPECT_EQ(failure("<BombClock name='b' in='drive'/>"), boom("BombClock", "inputs"));
  // Not the first one to be asked: another driver must not be blamed.
  EXPECT_EQ(failure("<BombClock name='b' in='next_event'/>"
                    "<BombClock name='c' in=''/>"),
            boom("BombClock", "inputs"));
  EXPECT_EQ(failure("<BombNotes name='b' in='record'/>"), boom("BombNotes", "record"));
}

TEST(AnOutputThatThrows, IsBlamedAndNotWhoReadsIt) {
  EXPECT_EQ(failure("<BombMass name='b'/><BombNotes name='n' in='reads'/>"),
            "test.xml:2: error: [/b] BombMass failed in stage 'record' of step 2: output 'bang': "
            "boom (a fault in the plugin 'fireworks', not in the scene: please report it)");
}

RunResult run(const std::string& elements, Diagnostics& diagnostics) {
  Registry registry;
  enrol_builtin(registry);
  registry.component<Mass>("Mass");
  registry.component<Pin>("Pin");
  enrol(registry);
  auto scene =
      load_scene_text("<sutura version='1'><plugin name='fireworks'/>\n" + elements + "</sutura>",
                      "test.xml", ".", registry, diagnostics);
  EXPECT_TRUE(scene);
  return run_scene(std::move(scene), {.steps = 3}, diagnostics);
}

TEST(AThrowInARun, EndsItWithTheExitCodeOfAFault) {
  for (const char* where : {"start", "record", "finish"}) {
    Diagnostics diagnostics;
    const RunResult result =
        run("<BombNotes name='b' in='" + std::string(where) + "'/>", diagnostics);
    EXPECT_EQ(result.end, RunEnd::failed) << where;
    EXPECT_EQ(diagnostics.exit_code(), 70) << where;
    EXPECT_EQ(diagnostics.errors(), 1u) << where;
  }
  Diagnostics diagnostics;
  EXPECT_EQ(run("<BombSolver name='b'/><Mass name='m'/><Pin/>", diagnostics).end, RunEnd::failed);
  EXPECT_NE(diagnostics.all().front().text().find("[/b] BombSolver failed in stage 'solve'"),
            std::string::npos);
}

TEST(AThrowInAnArchive, NamesTheComponentAndEndsTheSimulation) {
  const auto named = [](const std::string& how) {
    return "test.xml:2: error: [/b] BombClock failed while its state was " + how +
           ": boom (a fault in the plugin 'fireworks', not in the scene: please report it)";
  };
  const std::string head = "<plugin name='fireworks'/>\n<BombClock name='b' in='";
  const World saves(head + "save'/><Mass/>", enrol), restores(head + "restore'/><Mass/>", enrol);
  ASSERT_TRUE(saves.simulation && restores.simulation);
  EXPECT_TRUE(saves.simulation->save().empty());
  ASSERT_TRUE(saves.simulation->report().failure);
  EXPECT_EQ(saves.simulation->save("never_written"), named("saved"));
  EXPECT_FALSE(std::filesystem::exists("never_written"));

  const std::vector<std::byte> state = restores.simulation->save();
  EXPECT_EQ(restores.simulation->restore(state), named("restored"));
  EXPECT_EQ(restores.simulation->step().step, 0) << "half restored, and goes on";
}

TEST(AThrowInAnArchive, EndsARunWithTheExitCodeOfAFault) {
  Registry registry;
  enrol_builtin(registry);
  registry.component<Mass>("Mass");
  enrol(registry);
  Diagnostics diagnostics;
  auto scene = load_scene_text(
      "<sutura version='1' dt='10 ms'><plugin name='fireworks'/>\n<BombClock name='b' "
      "in='save'/><Mass/>"
      "</sutura>",
      "test.xml", ".", registry, diagnostics);
  ASSERT_TRUE(scene);
  const RunResult result =
      run_scene(std::move(scene), {.steps = 3, .checkpoint_every = 0.01}, diagnostics);
  EXPECT_EQ(result.end, RunEnd::failed);
  EXPECT_EQ(result.last, 1);
  EXPECT_EQ(diagnostics.exit_code(), 70);
}

TEST(TooManyRows, AreAnErrorOfTheSceneThatNamesWhoMakesThem) {
  const std::string most = std::to_string(most_rows / 3 - 1);
  Diagnostics fits, diagnostics;
  EXPECT_EQ(run("<Mass/><BombPin name='b' blocks='" + most + "'/>", fits).end, RunEnd::done);
  const RunResult result =
      run("<Mass/><BombPin name='b' blocks='" + most + "'/><Pin name='p'/>", diagnostics);
  EXPECT_EQ(result.end, RunEnd::failed);
  EXPECT_EQ(diagnostics.exit_code(), 2);
  ASSERT_EQ(diagnostics.errors(), 1u);
  EXPECT_EQ(diagnostics.all().front().text(),
            "test.xml:2: error: [/b] 4098 constraint rows in one step; expected at most 4096 (they "
            "are a dense system), of which this component makes 4095; 'blocks' decides how "
            "many");
}

}  // namespace
}  // namespace sutura::toys
