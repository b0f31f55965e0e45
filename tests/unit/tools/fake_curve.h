// A curve that does exactly what it is told: a straight rigid rod along its x axis that goes where
// its hold wants it. Lets tools and recorders be tested without a beam.
#pragma once

#include <algorithm>
#include <string>

#include "sutura/archive.h"
#include "sutura/body.h"
#include "sutura/describe.h"

namespace sutura::fake {

class Curve : public Component, public CurveBody {
 public:
  static void describe(Describe<Curve>& d) {
    d.summary("A rigid rod that follows its hold.");
    d.attribute("length", &Curve::length_, "m", above(0), "Length.");
    d.attribute("origin", &Curve::origin_, "m", any(), "Where the rod starts.");
    d.output("tip", "m", "The start of the rod.",
             [](const Curve& c) -> Vec3 { return c.point(0, Configuration::current); });
    d.output("held", "", "yes or no.",
             [](const Curve& c) -> std::string { return c.held_ ? "yes, held" : "no"; });
  }
  void initialise(Setup&) override { pose_.position = origin_; }

  void archive(Archive& a) override {
    a("pose", pose_);
    a("held", held_);
    a("target", target_);
  }

  // What the hold applies: known numbers.
  static Wrench applied() { return {{1, 2, 3}, {4, 5, 6}}; }
  bool held() const { return held_; }
  HoldStiffness stiffness() const { return stiffness_; }

  Index dofs() const override { return 6; }
  int width() const override { return 6; }
  void begin_step(const StepContext&) override {}
  void linearise(const StepContext&, const VecX&) override {}
  Eigen::Ref<const VecX> change() const override { return no_change_; }
  void jacobian(Real, PointJacobian& out) const override { out = {}; }
  void solve(Eigen::Ref<MatX> columns) const override { columns.setZero(); }
  void push(const StepContext&, const VecX&) override {}
  void correct(const StepContext&) override {}
  Imbalance imbalance(const StepContext&, const VecX&) override { return {}; }
  void end_step(const StepContext&, const VecX&) override {
    if (!held_) return;
    pose_.rotation = target_.rotation;
    pose_.position = target_.position - pose_.rotation * Vec3(hold_at_, 0, 0);
  }
  Vec3 momentum() const override { return Vec3::Zero(); }
  Real mass() const override { return 1; }
  Real energy() const override { return 0; }
  bool finite() const override { return true; }
  BodyGeometry geometry() const override {
    BodyGeometry g;
    for (int i = 0; i <= 4; ++i) g.points.push_back(point(length_ * i / 4, Configuration::current));
    g.connectivity = {0, 1, 1, 2, 2, 3, 3, 4};
    g.fields = {{"radius [m]", false, 1, std::vector<Real>(5, 1e-3)}};
    return g;
  }

  Real length() const override { return length_; }
  Real needle_length() const override { return 0; }
  Real radius(Real) const override { return 1e-3; }
  Real tension(Real) const override { return 0; }
  Vec3 point(Real s, Configuration) const override {
    return pose_.position + pose_.rotation * Vec3(s, 0, 0);
  }
  Vec3 tangent(Real, Configuration) const override { return pose_.rotation * Vec3::UnitX(); }
  Pose frame(Real s, Configuration c) const override { return {point(s, c), pose_.rotation}; }
  Real closest_abscissa(const Vec3& p, Real, Real low, Real high, Configuration c) const override {
    return std::clamp((p - point(0, c)).dot(tangent(0, c)), low, high);
  }
  Index add_hold(Real s) override {
    hold_at_ = s;
    return 0;
  }
  void set_hold(Index, const Pose& target, const HoldStiffness& stiffness) override {
    held_ = true;
    target_ = target;
    stiffness_ = stiffness;
  }
  void release_hold(Index) override { held_ = false; }
  Wrench hold_wrench(Index) const override { return applied(); }

 private:
  Real length_ = 0.1;
  Vec3 origin_ = Vec3::Zero();
  Pose pose_;
  VecX no_change_ = VecX::Zero(6);
  bool held_ = false;
  Real hold_at_ = 0;
  Pose target_;
  HoldStiffness stiffness_;
};

}  // namespace sutura::fake
