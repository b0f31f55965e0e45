// TissueLoad: force, moment, traction or pressure on a part of a tissue.
#pragma once

#include <vector>

#include "selection.h"
#include "sutura/describe.h"
#include "sutura/schedule.h"
#include "sutura/simulation.h"
#include "tissue.h"

namespace sutura::tissue {

class TissueLoad : public Component, public Driver, private FollowerLoad {
 public:
  static void describe(Describe<TissueLoad>& d);
  void initialise(Setup& setup) override;
  void drive(const StepContext& context) override;
  void archive(Archive& archive) override;
  void follow(const VecX& x, VecX& load) override;
  void add_stiffness(const VecX& x, Real scale, NodeMatrix& A) const override;

 private:
  void push(Index node, const Vec3& force);
  void add_moment(const Vec3& moment);

  Link<Tissue> tissue_;
  std::vector<Real> box_, times_, factors_;
  std::string region_;
  Vec3 force_ = Vec3::Zero(), moment_ = Vec3::Zero(), traction_ = Vec3::Zero();
  Real pressure_ = 0;

  Schedule schedule_;
  Selection part_;
  std::vector<Real> share_;     ///< of the whole, per node of part_
  std::vector<Vec3> on_faces_;  ///< of pressure, at each corner of each face of part_ (N)
  Real area_ = 0;               ///< at rest, m^2
  Vec3 applied_ = Vec3::Zero();
  Real factor_ = 0;
};

}  // namespace sutura::tissue
