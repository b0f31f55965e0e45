// Staple: a component that ties a point of one body to a point of another, or of the same.
#include <array>
#include <string>

#include "staple_law.h"
#include "sutura/archive.h"
#include "sutura/constraints.h"
#include "sutura/describe.h"
#include "sutura/plugin.h"

using namespace sutura;

/// A point of a thread or of a tissue: the one that is not null.
struct End {
  const CurveBody* thread = nullptr;
  Real abscissa = 0;
  const SolidBody* tissue = nullptr;
  EmbeddedPoint at;

  Vec3 position() const {
    constexpr auto now = Configuration::current;
    return thread != nullptr ? thread->point(abscissa, now) : tissue->position(at, now);
  }
  void jacobian(PointJacobian& J) const {
    thread != nullptr ? thread->jacobian(abscissa, J) : tissue->jacobian(at, J);
  }
};

class Staple : public Component, public ConstraintSource, public Drawing {
 public:
  static void describe(Describe<Staple>& d) {
    d.summary("Ties two points of bodies by a spring, until a force pulls it out.");
    d.link("first", &Staple::first_, "The body of the first point.");
    d.link("second", &Staple::second_, "The body of the second point; may be the same.");
    d.attribute("first_point", &Staple::first_point_, "m", any(), "The first point, at rest.");
    d.attribute("second_point", &Staple::second_point_, "m", any(), "The second point, at rest.");
    d.attribute("stiffness", &Staple::stiffness_, "N/m", above(0), "Force per stretch.");
    d.attribute("rest_length", &Staple::length_, "m", at_least(0),
                "Distance of the points up to which there is no force.");
    d.attribute("pull_out", &Staple::pull_out_, "N", above(0),
                "Force that pulls it out for good; left out, it is a spring that never gives way.");
    d.output("force", "N", "Force on the first point.", [](const Staple& s) { return s.force_; });
    d.output("length", "m", "Distance of the two points.",
             [](const Staple& s) { return s.span().norm(); });
    d.output("state", "", "slack, taut or out.", [](const Staple& s) -> std::string {
      return std::array{"slack", "taut", "out"}[s.mode_];
    });
  }

  void initialise(Setup& setup) override { source_id_ = setup.source_id; }

  void ready(Setup& setup) override {
    first_end_ = find_end(*first_, "first_point", first_point_, setup);
    second_end_ = find_end(*second_, "second_point", second_point_, setup);
  }

  void build(const StepContext&, ConstraintBuilder& builder) override {
    const Vec3 delta = span();
    block_ = builder.add<StapleLaw>(make_key(source_id_, 0), {stiffness_, length_, pull_out_},
                                    delta, mode_);
    PointJacobian J;
    first_end_.jacobian(J);
    builder.couple(block_, *first_, Mat3::Identity(), J, first_end_.position());
    second_end_.jacobian(J);
    builder.couple(block_, *second_, -Mat3::Identity(), J, second_end_.position());
  }

  void commit(const StepContext&, const SolvedBlocks& solved) override {
    force_ = solved.lambda(block_);
    mode_ = solved.mode(block_);
  }

  void archive(Archive& a) override {
    a("force", force_);
    a("mode", mode_);
  }

  BodyGeometry geometry() const override {
    if (mode_ == StapleLaw::out) return {};
    BodyGeometry line;
    line.points = {first_end_.position(), second_end_.position()};
    line.connectivity = {0, 1};
    line.fields = {{"force [N]", true, 1, {force_.norm()}}};
    return line;
  }

 private:
  Vec3 span() const { return first_end_.position() - second_end_.position(); }

  /// In a tissue or on its surface; of a thread the nearest of its two ends.
  End find_end(const Body& body, const char* attribute, const Vec3& p, Setup& setup) {
    End end{.thread = dynamic_cast<const CurveBody*>(&body),
            .tissue = dynamic_cast<const SolidBody*>(&body)};
    if (end.thread != nullptr) {
      const auto distance = [&](Real s) {
        return (end.thread->point(s, Configuration::current) - p).norm();
      };
      const Real length = end.thread->length();
      end.abscissa = distance(0) < distance(length) ? 0 : length;
      return end;
    }
    if (end.tissue != nullptr) {
      constexpr Real reach = 1e-4;  // what rounding may lift off the surface
      if (const auto inside = end.tissue->locate(p, Configuration::rest)) {
        end.at = *inside;
        return end;
      }
      if (const auto near = end.tissue->closest_surface(p, reach, Configuration::rest)) {
        end.at = near->at;
        return end;
      }
    }
    setup.error(*this, std::string(attribute) + " lies outside of its body");
    return end;
  }

  Link<Body> first_, second_;
  Vec3 first_point_ = Vec3::Zero(), second_point_ = Vec3::Zero();
  Real stiffness_ = 1e3;
  Real length_ = 0;
  Real pull_out_ = 1e6;

  Index source_id_ = 0;
  End first_end_, second_end_;
  BlockId block_;
  Vec3 force_ = Vec3::Zero();
  Mode mode_ = StapleLaw::slack;
};

static void enrol(Registry& registry) {
  registry.law<StapleLaw>();
  registry.component<Staple>("Staple");
}

SUTURA_PLUGIN(hello_staple, "1.0.0", "Apache-2.0", enrol)
