// TissueProbe: what a tissue does at a point, or on average over a part.
#pragma once

#include <vector>

#include "sutura/describe.h"
#include "sutura/probe.h"
#include "tissue.h"

namespace sutura::tissue {

class TissueProbe : public Component, public PointProbe {
 public:
  static void describe(Describe<TissueProbe>& d);
  void initialise(Setup& setup) override;
  Vec3 position() const override { return mean(tissue_->positions()); }

 private:
  bool at_point(Setup& setup);
  bool over_part(Setup& setup);
  Vec3 mean(const VecX& nodal) const;
  /// Of one tet: Biot strain, in the axes of the material at rest.
  Mat3 strain(Index tet) const;
  Mat3 stress(Index tet) const;
  Mat3 mean(Mat3 (TissueProbe::*of_tet)(Index) const) const;

  Link<Tissue> tissue_;
  Vec3 point_ = Vec3::Zero();
  std::vector<Real> box_;
  std::string region_;

  struct Share {
    Index number = 0;
    Real weight = 0;
  };
  std::vector<Share> nodes_, tets_;  ///< weights add up to 1
};

}  // namespace sutura::tissue
