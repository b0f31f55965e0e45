// TissueProbe: what a tissue does at a point, or on average over a part.
#pragma once

#include <array>
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
  void find_corners();
  Mat3 gradient(Index tet) const;
  /// Mean over the tets, in the axes of the material at rest: Biot strain, and stress.
  Mat3 strain() const;
  Mat3 stress() const;
  Real volume_strain(std::size_t tet) const;

  Link<Tissue> tissue_;
  Vec3 point_ = Vec3::Zero();
  std::vector<Real> box_;
  std::string region_;

  struct Share {
    Index number = 0;
    Real weight = 0;
  };
  std::vector<Share> nodes_, tets_;  ///< weights add up to 1
  // Where the element averages the strain of volume, the averages at the corners of each tet:
  std::vector<std::array<std::vector<Share>, 4>> corners_;
};

}  // namespace sutura::tissue
