// Band: a component that ties a section of a thread to a fixed point by an elastic band.
#include <array>
#include <string>

#include "band_law.h"
#include "sutura/archive.h"
#include "sutura/constraints.h"
#include "sutura/describe.h"
#include "sutura/plugin.h"

using namespace sutura;

class Band : public Component, public ConstraintSource {
 public:
  static void describe(Describe<Band>& d) {
    d.summary("Ties a section of a thread to a fixed point by an elastic band of limited tension.");
    d.link("thread", &Band::thread_, "The thread.");
    d.attribute("at", &Band::at_, "m", at_least(0), "Abscissa of the tied section.");
    d.attribute("anchor", &Band::anchor_, "m", any(), "The fixed point.");
    d.attribute("rest_length", &Band::rest_length_, "m", at_least(0),
                "Distance from which the band is stretched.");
    d.attribute("stiffness", &Band::stiffness_, "N/m", above(0), "Tension per stretch.");
    d.attribute("limit", &Band::limit_, "N", above(0), "Tension at which the band gives way.");
    d.output("tension", "N", "Force of the band on the thread.",
             [](const Band& b) { return b.tension_; });
    d.output("state", "", "slack, taut or yielding.", [](const Band& b) -> std::string {
      return std::array{"slack", "taut", "yielding"}[b.mode_];
    });
  }

  void initialise(Setup& setup) override {
    if (at_ > thread_->length()) setup.error(*this, "'at' lies beyond the end of the thread");
    source_id_ = setup.source_id;
  }

  void build(const StepContext&, ConstraintBuilder& builder) override {
    block_ = {};
    const Vec3 now = thread_->point(at_, Configuration::current);
    const Vec3 span = anchor_ - now;
    if (span.norm() < 1e-6) return;  // no direction to pull in
    const Eigen::Matrix<Real, 1, 3> along = span.normalized().transpose();

    // delta = along . (x - anchor) + rest length.
    const BlockVector<1> gap = along * (now - anchor_) + BlockVector<1>(rest_length_);
    block_ = builder.add<BandLaw>(make_key(source_id_, 0), {stiffness_, limit_}, gap);

    PointJacobian J;
    thread_->jacobian(at_, J);
    builder.couple(block_, *thread_, along, J, now);
  }

  void commit(const StepContext&, const SolvedBlocks& solved) override {
    tension_ = block_.valid() ? solved.lambda(block_)[0] : 0;
    mode_ = block_.valid() ? solved.mode(block_) : BandLaw::slack;
  }

  void archive(Archive& a) override {
    a("tension", tension_);
    a("mode", mode_);
  }

 private:
  Link<CurveBody> thread_;
  Real at_ = 0;
  Vec3 anchor_ = Vec3::Zero();
  Real rest_length_ = 0;
  Real stiffness_ = 1;
  Real limit_ = 1;

  Index source_id_ = 0;
  BlockId block_;
  Real tension_ = 0;
  Mode mode_ = BandLaw::slack;
};

static void enrol(Registry& registry) {
  registry.law<BandLaw>();
  registry.component<Band>("Band");
}

SUTURA_PLUGIN(hello_law, "1.0.0", "Apache-2.0", enrol)
