#include "step_checks.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "../../plugins/suturing/cutting_law.h"
#include "../../plugins/suturing/path_friction_law.h"
#include "../../plugins/suturing/puncture_law.h"
#include "solve/compliance.h"
#include "sutura/laws/bilateral.h"

namespace sutura::testing {
namespace {

// The plugins are loaded as libraries: laws are known by name.
bool is(const ConstraintBlock& b, const char* name) {
  return std::string_view(b.law->name) == name;
}
template <class L>
const typename L::Params* params_of(const ConstraintProblem& p, const ConstraintBlock& b) {
  if (!is(b, L::name) || b.law->params_size != sizeof(typename L::Params)) return nullptr;
  return static_cast<const typename L::Params*>(p.block_params(b));
}

/// What one block does to one body: force and moment about the origin per unit of each row.
struct Share {
  Eigen::Matrix<Real, 3, max_block_dim> force = decltype(force)::Zero();
  Eigen::Matrix<Real, 3, max_block_dim> moment = decltype(moment)::Zero();
  Vec3 mean =
      Vec3::Zero();  ///< sum of w x, the weights w from the first row; the point itself for a tet
};

Share share_of(const BodyRows& rows, const std::vector<Vec3>& x, const ConstraintBlock& b) {
  Share s;
  for (int k = 0; k < b.law->dim; ++k) {
    const auto at = std::lower_bound(rows.row.begin(), rows.row.end(), b.first_row + k);
    if (at == rows.row.end() || *at != b.first_row + k) continue;
    const auto i = static_cast<std::size_t>(at - rows.row.begin());
    const auto begin = static_cast<std::size_t>(rows.start[i]),
               end = static_cast<std::size_t>(rows.start[i + 1]);
    const auto translation = [&](std::size_t e) {
      return Vec3(Eigen::Map<const Vec3>(&rows.value[e * static_cast<std::size_t>(rows.width)]));
    };
    for (std::size_t e = begin; e < end; ++e) {
      const Vec3 f = translation(e);
      s.force.col(k) += f;
      s.moment.col(k) += x[static_cast<std::size_t>(rows.node[e])].cross(f);
      if (rows.width == 6) s.moment.col(k) += Eigen::Map<const Vec3>(&rows.value[e * 6 + 3]);
    }
    if (k > 0) continue;
    for (std::size_t e = begin; e < end; ++e)
      s.mean += translation(e).dot(s.force.col(0)) / s.force.col(0).squaredNorm() *
                x[static_cast<std::size_t>(rows.node[e])];
  }
  return s;
}

/// The point p with p x f = m for all rows of a block; two directions at least.
Vec3 lever(const Share& s, int dim) {
  Eigen::Matrix<Real, Eigen::Dynamic, 3> A(3 * dim, 3);
  VecX m(3 * dim);
  for (int k = 0; k < dim; ++k) {
    A.middleRows<3>(3 * k) = -cross_matrix(s.force.col(k));
    m.segment<3>(3 * k) = s.moment.col(k);
  }
  return A.colPivHouseholderQr().solve(m);
}

}  // namespace

ThirdLaw third_law(const Simulation& simulation, const ConstraintProblem& p) {
  ThirdLaw out;
  std::vector<std::vector<Vec3>> x;
  std::size_t thread = 0, tissue = 0;
  const CurveBody* curve = nullptr;
  for (std::size_t i = 0; i < simulation.bodies().size(); ++i) {
    const Body* body = simulation.bodies()[i].body;
    x.push_back(body->geometry().points);
    if (const auto* c = dynamic_cast<const CurveBody*>(body)) {
      curve = c, thread = i;
    } else {
      tissue = i;
    }
  }

  // All rows together, as the bodies get them.
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero(), expected = Vec3::Zero();
  Real forces = 0, moments = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int width = p.bodies[i].width;
    VecX f = VecX::Zero(simulation.bodies()[i].body->dofs());
    p.bodies[i].add_transposed(p.lambda, f);
    for (std::size_t n = 0; n < x[i].size(); ++n) {
      const Index at = width * static_cast<Index>(n);
      force += f.segment<3>(at);
      moment += x[i][n].cross(Vec3(f.segment<3>(at)));
      if (width == 6) moment += f.segment<3>(at + 3);
      forces += f.segment<3>(at).norm();
      moments += x[i][n].norm() * f.segment<3>(at).norm();
    }
  }
  // Block by block: the gap between the two points that it couples.
  std::map<std::uint64_t, Vec3> on_thread;  // of the samples, by id
  const auto sample = [](const ConstraintBlock& b) {
    return b.key.value & ((std::uint64_t{1} << 40) - 1);
  };
  for (const ConstraintBlock& b : p.blocks) {
    const int dim = b.law->dim;
    const Share a = share_of(p.bodies[thread], x[thread], b),
                c = share_of(p.bodies[tissue], x[tissue], b);
    const VecX lambda = p.lambda.segment(b.first_row, dim);
    const Vec3 f = a.force.leftCols(dim) * lambda;
    Vec3 at =
        curve->frame(0, Configuration::current).position;  // puncture and cutting act on the tip
    if (is(b, Bilateral<2>::name)) {
      at = on_thread[sample(b)] = lever(a, dim);
      // The search is local: help it where the thread is curved.
      Real off = INFINITY;
      for (int k = 0; k <= 20 && off > 1e-9; ++k) {
        const Real s = curve->closest_abscissa(at, curve->length() * k / 20, 0, curve->length(),
                                               Configuration::current);
        off = std::min(off, (curve->frame(s, Configuration::current).position - at).norm());
      }
      out.off_curve = std::max(out.off_curve, off);
      if (f.norm() > 0) out.gap = std::max(out.gap, (at - c.mean).norm());
    } else if (is(b, suturing::PathFrictionLaw::name)) {
      // One row shows its lever arm only; a sample too close to the tip has no other rows.
      const Vec3 along = a.force.col(0), moment = a.moment.col(0);
      const auto known = on_thread.find(sample(b));
      at = known != on_thread.end()
               ? known->second
               : Vec3(c.mean + along.cross(moment - c.mean.cross(along)) / along.squaredNorm());
      if (f.norm() > 0) out.gap = std::max(out.gap, (at - c.mean).norm());
    }
    expected += (at - c.mean).cross(f);
  }
  if (forces > 0) out.force = force.norm() / forces;
  if (moments > 0) out.moment = (moment - expected).norm() / moments;
  return out;
}

ForceTolerance::ForceTolerance(const ConstraintProblem& solved, Real length) : length_(length) {
  Compliance compliance;
  compliance.prepare(solved);
  for (std::size_t i = 0; i < solved.blocks.size(); ++i) {
    const int dim = solved.blocks[i].law->dim;
    const Eigen::Map<const MatX> W(compliance[i], dim, dim);
    softness_[solved.blocks[i].key] =
        Eigen::SelfAdjointEigenSolver<MatX>(W, Eigen::EigenvaluesOnly).eigenvalues()[0];
  }
}

Real ForceTolerance::of(const ConstraintBlock& b, Real drag) const {
  const auto known = softness_.find(b.key);
  const Real softness = known != softness_.end() ? known->second : b.units.length / b.units.force;
  return length_ * (1 / softness + drag);
}

namespace {

Real drag_of(const ConstraintProblem& p, const ConstraintBlock& b) {
  if (const auto* q = params_of<suturing::PunctureLaw>(p, b)) return q->drag;
  if (const auto* q = params_of<suturing::PathFrictionLaw>(p, b)) return q->viscous;
  return 0;
}

}  // namespace

Real outside_admissible(const ConstraintProblem& p, const ForceTolerance& tolerance,
                        std::string& who) {
  Real worst = 0;
  const auto note = [&](const ConstraintBlock& b, Real force) {
    const Real by = force / tolerance.of(b, drag_of(p, b));
    if (!(by <= worst)) worst = by, who = b.law->name;
  };
  for (const ConstraintBlock& b : p.blocks) {
    const VecX l = p.lambda.segment(b.first_row, b.law->dim),
               d = p.delta.segment(b.first_row, b.law->dim);
    if (!l.allFinite()) note(b, INFINITY);
    if (const auto* q = params_of<suturing::PunctureLaw>(p, b);
        q && b.mode != suturing::PunctureLaw::penetrated) {
      const Real n = q->normal.dot(l.head<3>());
      note(b, -n);
      note(b, n - q->puncture_force);
      note(b, (l.head<3>() - n * q->normal).norm() - q->friction * std::max(n, Real(0)));
    } else if (q) {
      const Real r = -q->axis.dot(l.head<3>()), slid = std::max(q->axis.dot(d.head<3>()), Real(0));
      note(b, -r);
      note(b, r - (q->cutting_force + q->drag * slid));
      if (!q->hold) note(b, (l.head<3>() + r * q->axis).norm());
    } else if (const auto* cut = params_of<suturing::CuttingLaw>(p, b)) {
      note(b, -l[0]);
      note(b, l[0] - cut->threshold);
    } else if (const auto* drag = params_of<suturing::PathFrictionLaw>(p, b)) {
      const Real level =
          b.mode == suturing::PathFrictionLaw::stick ? drag->static_level : drag->kinetic;
      note(b, std::abs(l[0]) - (level + drag->viscous * std::abs(d[0])));
    }
  }
  return worst;
}

Real off_graph(const ConstraintProblem& p, const ForceTolerance& tolerance, std::string& who) {
  Real worst = 0;
  const auto note = [&](const ConstraintBlock& b, Real by) {
    if (!(by <= worst)) worst = by, who = b.law->name;
  };
  for (const ConstraintBlock& b : p.blocks) {
    const VecX l = p.lambda.segment(b.first_row, b.law->dim),
               d = p.delta.segment(b.first_row, b.law->dim);
    const Real margin = tolerance.of(b, drag_of(p, b));
    /// 0 <= gap _|_ push >= 0 below the limit, gap <= 0 at it.
    const auto clamp = [&](Real gap, Real push, Real limit) {
      if (push > margin) note(b, gap);
      if (push < limit - margin) note(b, -gap);
    };
    /// Zero inside the limit, against the force at it.
    const auto friction = [&](const VecX& slip, const VecX& force, Real limit) {
      if (force.norm() < limit - margin) return note(b, slip.norm());
      if (force.norm() > margin) note(b, (slip + slip.norm() * force / force.norm()).norm());
    };
    if (const auto* hold = params_of<Bilateral<2>>(p, b)) {
      note(b, (d + hold->compliance * l).norm());
    } else if (const auto* q = params_of<suturing::PunctureLaw>(p, b);
               q && b.mode != suturing::PunctureLaw::penetrated) {
      const Real n = q->normal.dot(l.head<3>()), gap = q->normal.dot(d.head<3>());
      clamp(gap, n, q->puncture_force);
      if (n > margin)
        friction(d.head<3>() - gap * q->normal, l.head<3>() - n * q->normal, q->friction * n);
    } else if (q) {
      const Real r = -q->axis.dot(l.head<3>()), slid = q->axis.dot(d.head<3>());
      if (q->hold) note(b, (d.head<3>() - slid * q->axis).norm());
      clamp(-slid, r, q->cutting_force + q->drag * std::max(slid, Real(0)));
    } else if (const auto* cut = params_of<suturing::CuttingLaw>(p, b)) {
      clamp(d[0], l[0], cut->threshold);
    } else if (const auto* drag = params_of<suturing::PathFrictionLaw>(p, b)) {
      const Real level =
          b.mode == suturing::PathFrictionLaw::stick ? drag->static_level : drag->kinetic;
      friction(d, l, level + drag->viscous * std::abs(d[0]));
    }
  }
  return worst;
}

}  // namespace sutura::testing
