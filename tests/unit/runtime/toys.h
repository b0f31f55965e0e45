// Components that do next to nothing and write down when they are asked to do it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sutura/archive.h"
#include "sutura/describe.h"
#include "sutura/laws/bilateral.h"
#include "sutura/registry.h"
#include "sutura/simulation.h"
#include "text_world.h"

namespace sutura::toys {

/// What happened, in order: "free_motion /a", ...
using Log = std::vector<std::string>;
inline Log& log() {
  static Log calls;
  return calls;
}
inline void note(const std::string& what, const Component& who) {
  log().push_back(what + " " + who.path());
}

/// One node of 1 kg, free in all three directions, without any stiffness.
class Mass : public Component, public Body {
 public:
  static constexpr const char* interface_name = "Mass";
  static void describe(Describe<Mass>& d) {
    d.summary("A point mass.");
    d.attribute("forgetful", &Mass::forgetful, "Whether it saves more than it restores.");
    d.attribute("refuses_before", &Mass::refuses_before, any(),
                "Steps that a state which it takes back has at least.");
    d.attribute("fails_at", &Mass::fails_at, any(),
                "Step after which x is not a number; -1: none.");
  }
  Index fails_at = -1, refuses_before = 0;
  bool forgetful = false;
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), start_x = Vec3::Zero(), start_v = Vec3::Zero();
  VecX motion = VecX::Zero(3);  ///< change of the velocity to the next guess
  bool in_step = false;
  Index step = 0;

  void initialise(Setup&) override { note("initialise", *this); }
  void archive(Archive& a) override {
    a("x", x);
    a("v", v);
    if (!forgetful || !a.restoring()) a("step", step);
    if (a.restoring() && step < refuses_before) a.fail("it is too young");
  }
  Index dofs() const override { return 3; }
  int width() const override { return 3; }
  void begin_step(const StepContext& c) override {
    if (!in_step) {
      start_x = x;
      start_v = v;
    }
    in_step = true;
    v = start_v;
    x = start_x + c.dt * v;
  }
  void linearise(const StepContext& c, const VecX& force) override {
    note("linearise", *this);
    motion = start_v - v + c.dt * (c.gravity + force);
  }
  Eigen::Ref<const VecX> change() const override { return motion; }
  void solve(Eigen::Ref<MatX>) const override {}  // A = 1 kg
  void push(const StepContext& c, const VecX& force_change) override {
    motion += c.dt * force_change;
  }
  void correct(const StepContext& c) override {
    note("correct", *this);
    v += motion;
    x = start_x + c.dt * v;
  }
  Imbalance imbalance(const StepContext& c, const VecX& force) override {
    const Real missing = ((start_v - v) / c.dt + c.gravity + force).norm();
    return {missing, missing / c.gravity.norm()};
  }
  void end_step(const StepContext&, const VecX&) override {
    in_step = false;
    if (step++ == fails_at) x.x() = std::numeric_limits<Real>::quiet_NaN();
  }
  Vec3 momentum() const override { return v; }
  Real mass() const override { return 1; }
  Real energy() const override { return v.squaredNorm() / 2; }
  bool finite() const override { return x.allFinite(); }
  std::string trouble() const override { return finite() ? "" : "it broke"; }
  BodyGeometry geometry() const override { return {}; }
};

/// Holds a mass where it is.
class Pin : public Component, public ConstraintSource {
 public:
  static constexpr const char* interface_name = "Pin";
  static void describe(Describe<Pin>& d) {
    d.summary("Holds a mass.");
    d.link("mass", &Pin::mass, "What it holds.");
  }
  Link<Mass> mass;
  Index id = 0;
  Vec3 force = Vec3::Zero();  ///< N, in the last step

  void initialise(Setup& setup) override {
    note("initialise", *this);
    id = setup.source_id;
  }
  void archive(Archive& a) override { a("force", force); }
  void detect(const StepContext&) override { note("detect", *this); }
  void build(const StepContext&, ConstraintBuilder& builder) override {
    note("build", *this);
    block_ = builder.add<Bilateral<3>>(make_key(id, 0), {}, mass->x);
    PointJacobian J;
    J.nodes = 1;
    J.coefficients = Mat3::Identity();
    builder.couple(block_, *mass, Mat3::Identity(), J, mass->x);
  }
  void commit(const StepContext&, const SolvedBlocks& solved) override {
    note("commit", *this);
    force = solved.force(block_);
  }

 private:
  BlockId block_;
};

/// A pin that links to another one.
class LatePin : public Pin {
 public:
  static void describe(Describe<LatePin>& d) {
    d.summary("Holds a mass, after another pin.");
    d.link("mass", static_cast<Link<Mass> LatePin::*>(&Pin::mass), "What it holds.");
    d.link("after", &LatePin::after, "Another pin, asked before this one.");
  }
  Link<Pin> after;
};

/// Writes down the times it is told.
class Clock : public Component, public Driver {
 public:
  static void describe(Describe<Clock>& d) { d.summary("Notes the time."); }
  std::vector<Real> begin, end;
  void drive(const StepContext& c) override {
    note("drive", *this);
    begin.push_back(c.time);
    end.push_back(c.end());
  }
};

/// Notes the steps it records; says that it cannot write from step `breaks_at` on.
class Notes : public Component, public Recorder {
 public:
  static void describe(Describe<Notes>& d) {
    d.summary("Notes the steps.");
    d.attribute("breaks_at", &Notes::breaks_at, any(), "Step from which on it fails; -1: never.");
  }
  Index breaks_at = -1;
  std::vector<Index> steps;
  bool finished = false;
  std::string start(const Simulation&) override { return {}; }
  std::string record(const Simulation&, const StepReport& report) override {
    steps.push_back(report.step);
    return breaks_at >= 0 && report.step >= breaks_at ? path() + ": the disk is full" : "";
  }
  std::string finish(const Simulation&) override {
    finished = true;
    return {};
  }
};

/// Cannot be set up.
class Broken : public Component {
 public:
  static constexpr const char* interface_name = "Broken";
  static void describe(Describe<Broken>& d) { d.summary("Fails to start."); }
  void initialise(Setup& setup) override { setup.error(*this, "it does not work"); }
};

/// Leans on a Broken, and must not be asked.
class Leaning : public Component {
 public:
  static void describe(Describe<Leaning>& d) {
    d.summary("Needs what is broken.");
    d.link("on", &Leaning::on, "What it needs.");
  }
  Link<Broken> on;
  void initialise(Setup&) override { note("initialise", *this); }
};

/// A scene out of a few elements, compiled.
struct World : test::TextWorld {
  /// `more` enrols components of the test's own.
  explicit World(const std::string& elements, void (*more)(Registry&) = nullptr) {
    log().clear();
    if (more != nullptr) more(registry);
    enrol_builtin(registry);
    registry.component<Mass>("Mass");
    registry.component<Pin>("Pin");
    registry.component<LatePin>("LatePin");
    registry.component<Clock>("Clock");
    registry.component<Notes>("Notes");
    registry.component<Broken>("Broken");
    registry.component<Leaning>("Leaning");
    load("dt='0.1 s' gravity='0 0 -10'", elements);
  }
};

}  // namespace sutura::toys
