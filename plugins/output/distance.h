// Distance: how far two probed points are from each other.
#pragma once

#include "sutura/describe.h"
#include "sutura/probe.h"

namespace sutura::output {

class Distance : public Component {
 public:
  static void describe(Describe<Distance>& d) {
    d.summary("The distance between any two points that probes of tissue or thread read.");
    d.link("from", &Distance::from_, "Probe of the first point.");
    d.link("to", &Distance::to_, "Probe of the second point.");
    d.output("distance", "m", "Length of the straight line from one to the other.",
             [](const Distance& x) -> Real { return x.span().norm(); });
    d.output("vector", "m", "From the first point to the second.",
             [](const Distance& x) { return x.span(); });
  }

 private:
  Vec3 span() const { return to_->position() - from_->position(); }

  Link<PointProbe> from_, to_;
};

}  // namespace sutura::output
