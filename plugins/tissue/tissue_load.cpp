#include "tissue_load.h"

#include <Eigen/LU>
#include <algorithm>

#include "sutura/archive.h"

namespace sutura::tissue {

void TissueLoad::describe(Describe<TissueLoad>& d) {
  using T = TissueLoad;
  d.summary(
      "A load on a part of a tissue's surface, or on nodes inside: force, moment, traction or "
      "pressure, constant or by key frames.");
  d.theory(
      "The part is the faces of the boundary whose corners all lie in `box` and that belong to "
      "`region`; both are of the shape at rest, and one of them may be left out. Where the box "
      "holds no such face, force and moment act on its nodes, in equal shares.\n\n"
      "Force and traction (force per area at rest) keep their direction, spread by area. A moment "
      "is spread as forces *f_i = w_i a x (x_i - c)* about the middle *c* of the part, *w_i* the "
      "share of node *i* and *a* such that their moment is the one asked for; it keeps its axis. "
      "Pressure pushes against the outward normal of the surface as it is at the end of each step, "
      "found in the passes. All of them are multiplied by the factor of the time, which is "
      "interpolated "
      "along lines between `times`, and 1 without them.");
  d.link("tissue", &T::tissue_, "The tissue that is loaded.");
  d.attribute("box", &T::box_, "m", any(), "Two opposite corners of the box, at rest.");
  d.attribute("region", &T::region_, "Name or number of a region of the mesh.");
  d.attribute("force", &T::force_, "N", any(), "Force on the whole part.");
  d.attribute("moment", &T::moment_, "N m", any(), "Moment on the whole part, about its middle.");
  d.attribute("traction", &T::traction_, "Pa", any(), "Force per area at rest.");
  d.attribute("pressure", &T::pressure_, "Pa", any(),
              "Pressure on the surface, following it; negative pulls.");
  d.attribute("times", &T::times_, "s", any(), "Times of the factors, increasing.");
  d.attribute("factors", &T::factors_, "1", any(),
              "By what the load is multiplied at each of the times.");
  d.output("force", "N", "Sum of the forces in the last step.",
           [](const T& l) { return l.applied_; });
  d.output("area", "m^2", "Area of the loaded faces at rest.", [](const T& l) { return l.area_; });
  d.output("factor", "1", "Factor of the load at the end of the step.",
           [](const T& l) { return l.factor_; });
}

void TissueLoad::initialise(Setup& setup) {
  if (box_.empty() && region_.empty())
    return setup.error(*this, "one of 'box' and 'region' is needed");
  if (force_.isZero(0) && moment_.isZero(0) && traction_.isZero(0) && pressure_ == 0)
    return setup.error(*this, "none of 'force', 'moment', 'traction' and 'pressure' is given");
  if (const std::string wrong = Schedule::check(times_, factors_); !wrong.empty())
    return setup.error(*this, wrong);
  setup.warn_of_hidden_keys(*this, times_);
  setup.warn_of_hidden_start(*this, times_);
  schedule_ = Schedule(times_, factors_);
  std::string error;
  std::optional<Selection> part = select(*tissue_->mesh, box_, region_, error);
  if (!part) return setup.error(*this, error);
  part_ = std::move(*part);
  const bool on_faces = !part_.faces.empty();
  if (!on_faces && (!traction_.isZero(0) || pressure_ != 0))
    return setup.error(*this, "no face of the tissue's boundary lies in the part that is loaded");
  if (part_.nodes.empty())
    return setup.error(*this, "no node of the tissue lies in the part that is loaded");
  if (on_faces) {
    part_.nodes.clear();
    for (const BoundaryFace& face : part_.faces)
      part_.nodes.insert(part_.nodes.end(), face.nodes.begin(), face.nodes.end());
    std::sort(part_.nodes.begin(), part_.nodes.end());
    part_.nodes.erase(std::unique(part_.nodes.begin(), part_.nodes.end()), part_.nodes.end());
  }
  share_.assign(part_.nodes.size(), on_faces ? 0 : 1 / static_cast<Real>(part_.nodes.size()));
  const std::vector<Vec3>& rest = tissue_->mesh->data().points;
  for (const BoundaryFace& face : part_.faces) {
    const Real area = (rest[face.nodes[1]] - rest[face.nodes[0]])
                          .cross(rest[face.nodes[2]] - rest[face.nodes[0]])
                          .norm() /
                      2;
    area_ += area;
    for (const Index i : face.nodes)
      share_[static_cast<std::size_t>(std::lower_bound(part_.nodes.begin(), part_.nodes.end(), i) -
                                      part_.nodes.begin())] += area / 3;
  }
  if (on_faces)
    for (Real& w : share_) w /= area_;
  if (pressure_ != 0) {
    on_faces_.assign(part_.faces.size(), Vec3::Zero());
    tissue_->add_follower(*this);
  }
  if (!moment_.isZero(0) && part_.nodes.size() < 3)
    setup.error(*this, "a moment needs three nodes to act on, not in one line");
}

void TissueLoad::archive(Archive& a) {
  a("force", applied_);
  a("factor", factor_);
}

void TissueLoad::push(Index node, const Vec3& force) {
  tissue_->load().segment<3>(3 * node) += force;
  applied_ += force;
}

void TissueLoad::add_moment(const Vec3& moment) {
  const VecX& x = tissue_->positions();
  Vec3 middle = Vec3::Zero();
  for (std::size_t k = 0; k < share_.size(); ++k)
    middle += share_[k] * x.segment<3>(3 * part_.nodes[k]);
  Mat3 inertia = Mat3::Zero();
  for (std::size_t k = 0; k < share_.size(); ++k) {
    const Vec3 r = x.segment<3>(3 * part_.nodes[k]) - middle;
    inertia += share_[k] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  const Vec3 a = inertia.fullPivLu().solve(moment);
  for (std::size_t k = 0; k < share_.size(); ++k)
    push(part_.nodes[k], share_[k] * a.cross(x.segment<3>(3 * part_.nodes[k]) - middle));
}

void TissueLoad::follow(const VecX& x, VecX& load) {
  const Real pressure = factor_ * pressure_;
  for (std::size_t k = 0; k < on_faces_.size(); ++k) {
    const auto& node = part_.faces[k].nodes;
    const Vec3 a = x.segment<3>(3 * node[0]), b = x.segment<3>(3 * node[1]),
               c = x.segment<3>(3 * node[2]);
    const Vec3 force = -pressure / 6 * (b - a).cross(c - a), change = force - on_faces_[k];
    on_faces_[k] = force;
    for (const Index i : node) load.segment<3>(3 * i) += change;
    applied_ += 3 * change;
  }
}

/// The force at each corner changes by p/6 e_j x dx_j as corner j moves, e_j the opposite side. Its
/// skew part cancels between faces that share a side, and at a rim it is left out.
void TissueLoad::add_stiffness(const VecX& x, Real scale, NodeMatrix& A) const {
  const Real part = scale * factor_ * pressure_ / 12;
  Real* const values = A.values();
  for (std::size_t k = 0; k < on_faces_.size(); ++k) {
    const auto& node = part_.faces[k].nodes;
    const auto side = [&](std::size_t j) {
      return Vec3(x.segment<3>(3 * node[(j + 1) % 3]) - x.segment<3>(3 * node[(j + 2) % 3]));
    };
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        if (node[i] >= node[j]) continue;
        const Vec3 s = part * (side(i) - side(j));
        Mat3 cross;
        cross << 0, -s.z(), s.y(), s.z(), 0, -s.x(), -s.y(), s.x(), 0;
        Eigen::Map<Eigen::Matrix<Real, 3, 3, Eigen::RowMajor>>(
            values + 9 * A.slot(node[i], node[j])) += cross;
      }
  }
}

void TissueLoad::drive(const StepContext& context) {
  applied_.setZero();
  factor_ = schedule_.at(context.end());
  const Vec3 sum = factor_ * (force_ + area_ * traction_);
  for (std::size_t k = 0; k < share_.size(); ++k) push(part_.nodes[k], share_[k] * sum);
  if (!moment_.isZero(0)) add_moment(factor_ * moment_);
  std::fill(on_faces_.begin(), on_faces_.end(), Vec3::Zero());
  follow(tissue_->positions(), tissue_->load());
}

}  // namespace sutura::tissue
