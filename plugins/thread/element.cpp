#include "element.h"

#include <algorithm>
#include <cmath>

namespace sutura::thread {

namespace {

/// First axis of the rotation q.
inline Vec3 x_axis(const Quat& q) {
  const Real w = q.w(), x = q.x(), y = q.y(), z = q.z();
  return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
}

/// Angle vector from the unit vector e to the unit vector t.
Vec3 angle_vector(const Vec3& e, const Vec3& t) {
  const Vec3 s = e.cross(t);
  const Real sine = s.norm(), cosine = e.dot(t);
  return sine > 1e-12 ? Vec3(s * (std::atan2(sine, cosine) / sine)) : s;
}

/// g = angle/sin(angle) and dg/dx as functions of x = 1 - cos(angle); series where the closed form
/// cancels (x < 0.1, truncation below 1e-13), bounded away from the singularity at half a turn.
inline void angle_factor(Real x, Real& g, Real& dg) {
  if (x < 0.1) {
    // sum over n of 2^n x^(n-1) / (n binomial(2n, n))
    constexpr Real c[] = {1.,           1. / 3,     2. / 15,    2. / 35,       8. / 315,
                          8. / 693,     16. / 3003, 16. / 6435, 128. / 109395, 128. / 230945,
                          256. / 969969};
    g = c[10];
    dg = 0;
    for (int i = 9; i >= 0; --i) {
      dg = dg * x + g;
      g = g * x + c[i];
    }
    return;
  }
  x = std::min(x, 1.99);
  const Real mu = 1 - x, s2 = x * (2 - x);
  g = std::acos(mu) / std::sqrt(s2);
  dg = (1 - g * mu) / s2;
}

/// d2g/dx2, from the differential equation of g.
Real angle_factor_second(Real x, Real g, Real dg) {
  if (x < 0.1) {
    constexpr Real c[] = {2. / 15,    2. / 35,       8. / 315,      8. / 693,     16. / 3003,
                          16. / 6435, 128. / 109395, 128. / 230945, 256. / 969969};
    Real sum = 0;
    for (int i = 8; i >= 0; --i) sum = sum * x + (i + 2) * (i + 1) * c[i];
    return sum;
  }
  x = std::min(x, 1.99);
  return (g - 3 * (1 - x) * dg) / (x * (2 - x));
}

/// Derivatives of U with respect to its scalars, tension included.
struct ScalarGradient {
  Real mu_a, mu_b, m, nu_a, nu_b, phi;
};
ScalarGradient scalar_gradient(const ElementRest& r, const ElementState& s) {
  const Real nl = s.tension * r.length / 30;
  const Real up = r.bend_1 / 2 + 2 * nl;  // d/d|theta_a|^2
  const Real ur = r.bend_2 - nl;          // d/d(theta_a.theta_b)
  const Real mu_a = 1 - s.xa, mu_b = 1 - s.xb;
  ScalarGradient d;
  // d|theta|^2/dmu = -2 g; theta_a.theta_b = ga gb (m - mu_a mu_b).
  d.mu_a = -2 * up * s.ga - ur * s.gb * (s.dga * s.product + s.ga * mu_b);
  d.mu_b = -2 * up * s.gb - ur * s.ga * (s.dgb * s.product + s.gb * mu_a);
  d.m = ur * s.ga * s.gb;
  d.phi = r.torsion * s.twist;
  d.nu_a = d.nu_b = 0;
  if (r.curved) {
    d.mu_a -= nl * s.dga * s.e.dot(s.na);
    d.mu_b -= nl * s.dgb * s.e.dot(s.nb);
    d.nu_a = nl * s.ga;
    d.nu_b = nl * s.gb;
  }
  return d;
}

}  // namespace

ElementRest::ElementRest(const Pose& a, const Pose& b, Real arc_length, const Section& section)
    : length(arc_length) {
  const Vec3 span = b.position - a.position;
  chord = span.norm();
  const Vec3 e = span / chord;
  const Vec3 ta = x_axis(a.rotation), tb = x_axis(b.rotation);
  const Quat frame = shortest_rotation(ta, e) * a.rotation;
  frame_a = (a.rotation.conjugate() * frame).normalized();
  frame_b = (b.rotation.conjugate() * frame).normalized();
  const Vec3 wa = angle_vector(e, ta), wb = angle_vector(e, tb);
  curved = wa.norm() + wb.norm() > 1e-9;
  if (!curved) {
    frame_a = Quat::Identity();
    chord = length;
  }
  bow_a = curved ? Vec3(a.rotation.conjugate() * (4 * wa - wb)) : Vec3::Zero();
  bow_b = curved ? Vec3(b.rotation.conjugate() * (4 * wb - wa)) : Vec3::Zero();

  const Real ei = section.bending_stiffness();
  const Real shear = 12 * ei / (section.shear_stiffness() * length * length);
  axial = section.axial_stiffness();
  bend_1 = ei / length * (4 + shear) / (1 + shear);
  bend_2 = ei / length * (2 - shear) / (1 + shear);
  torsion = section.torsion_stiffness() / length;
  mass = section.density * section.area() * length;
  rotary = section.density * section.second_moment();
}

void evaluate(const ElementRest& r, const Pose& a, const Pose& b, Real twist_reference,
              ElementState& s) {
  const Vec3 span = b.position - a.position;
  s.l = span.norm();
  s.e = span / s.l;
  const Quat fa = a.rotation * r.frame_a, fb = b.rotation * r.frame_b;
  s.ca = x_axis(fa);
  s.cb = x_axis(fb);
  const Vec3 sa = s.e.cross(s.ca), sb = s.e.cross(s.cb);
  // 1 - cos without cancellation: |e - c|^2 / 2.
  s.xa = (s.e - s.ca).squaredNorm() / 2;
  s.xb = (s.e - s.cb).squaredNorm() / 2;
  s.m = s.ca.dot(s.cb);
  s.product = sa.dot(sb);
  angle_factor(s.xa, s.ga, s.dga);
  angle_factor(s.xb, s.gb, s.dgb);
  s.theta_a = s.ga * sa;
  s.theta_b = s.gb * sb;
  Real bow = 2 * s.theta_a.squaredNorm() - s.theta_a.dot(s.theta_b) + 2 * s.theta_b.squaredNorm();
  if (r.curved) {
    s.ta = x_axis(a.rotation);
    s.tb = x_axis(b.rotation);
    s.na = s.ca.cross(a.rotation * r.bow_a);
    s.nb = s.cb.cross(b.rotation * r.bow_b);
    bow += s.ga * s.e.dot(s.na) + s.gb * s.e.dot(s.nb);
  } else {
    s.ta = s.ca;
    s.tb = s.cb;
  }
  s.strain = (s.l - r.chord) / r.length + bow / 30;
  s.tension = r.axial * s.strain;

  // Twist of the swing-twist split of fa^-1 fb about x.
  const Real w = fa.w() * fb.w() + fa.vec().dot(fb.vec());
  const Real x = fa.w() * fb.x() - fb.w() * fa.x() - (fa.y() * fb.z() - fa.z() * fb.y());
  constexpr Real turn = 2 * std::numbers::pi;
  const Real raw = 2 * std::atan2(x, w);
  s.twist = raw + turn * std::round((twist_reference - raw) / turn);
  s.twist_axis = (s.ca + s.cb) / std::max(1 + s.m, 1e-3);
}

Real elastic_energy(const ElementRest& r, const ElementState& s) {
  return (r.axial * r.length * s.strain * s.strain +
          r.bend_1 * (s.theta_a.squaredNorm() + s.theta_b.squaredNorm()) +
          2 * r.bend_2 * s.theta_a.dot(s.theta_b) + r.torsion * s.twist * s.twist) /
         2;
}

ElementGradient gradient(const ElementRest& r, const ElementState& s) {
  const ScalarGradient d = scalar_gradient(r, s);
  ElementGradient g;
  Vec3 pull = d.mu_a * s.ca + d.mu_b * s.cb;  // becomes its part normal to e
  const Vec3 both = d.m * s.ca.cross(s.cb) - d.phi * s.twist_axis;
  g.a = d.mu_a * s.ca.cross(s.e) + both;
  g.b = d.mu_b * s.cb.cross(s.e) - both;
  if (r.curved) {
    pull += d.nu_a * s.na + d.nu_b * s.nb;
    g.a += d.nu_a * s.na.cross(s.e);
    g.b += d.nu_b * s.nb.cross(s.e);
  }
  g.v = s.tension * s.e + (pull - pull.dot(s.e) * s.e) / s.l;
  return g;
}

namespace {

/// Gradient of e.c, c carried by the section whose spin starts at `block`.
Vec9 tilt_gradient(const ElementState& s, const Vec3& c, int block) {
  Vec9 g = Vec9::Zero();
  g.head<3>() = (c - c.dot(s.e) * s.e) / s.l;
  g.segment<3>(block) = c.cross(s.e);
  return g;
}

/// Gradient of m = c_a.c_b.
Vec9 angle_gradient(const ElementState& s) {
  Vec9 g = Vec9::Zero();
  g.segment<3>(3) = s.ca.cross(s.cb);
  g.segment<3>(6) = -g.segment<3>(3);
  return g;
}

}  // namespace

Vec9 strain_gradient(const ElementRest& r, const ElementState& s) {
  const Vec9 gmu_a = tilt_gradient(s, s.ca, 3), gmu_b = tilt_gradient(s, s.cb, 6);
  Vec9 g = ((-4 * s.ga + s.gb * (s.dga * s.product + s.ga * (1 - s.xb))) * gmu_a +
            (-4 * s.gb + s.ga * (s.dgb * s.product + s.gb * (1 - s.xa))) * gmu_b -
            s.ga * s.gb * angle_gradient(s)) /
           30;
  if (r.curved) {
    g += (s.ga * tilt_gradient(s, s.na, 3) - s.dga * s.e.dot(s.na) * gmu_a +
          s.gb * tilt_gradient(s, s.nb, 6) - s.dgb * s.e.dot(s.nb) * gmu_b) /
         30;
  }
  g.head<3>() += s.e / r.length;
  return g;
}

// The directors move against the chord, which rolls by kappa e . (spin_a + spin_b):
//   d c_a = (spin_a - turn of the chord) x c_a
//         = (e c_a^T - mu_a I) v / l - [c_a] spin_a + kappa (c_a x e) e . (spin_a + spin_b),
// and so for b. Bending is c1 (d c_a^2 + d c_b^2) + 2 c2 d c_a . d c_b; its products are written
// out, as [c_a]^T [c_b] = (c_a . c_b) I - c_b c_a^T.
void step_stiffness(const ElementRest& r, const ElementState& s, Real n, Real chord_roll,
                    ElementMatrix& k) {
  const Real c1 = r.bend_1 + 4 * n * r.length / 30, c2 = r.bend_2 - n * r.length / 30;
  const Real kappa = chord_roll / 2, mu_a = 1 - s.xa, mu_b = 1 - s.xb;
  const Vec3 pa = s.ca.cross(s.e), pb = s.cb.cross(s.e);
  // A director with its weight and the other with its own, and what of that is along the chord.
  const Vec3 qa = c1 * s.ca + c2 * s.cb, qb = c2 * s.ca + c1 * s.cb;
  const Real along_a = c1 * mu_a + c2 * mu_b, along_b = c2 * mu_a + c1 * mu_b;

  // What the roll of the chord couples.
  const Vec3 wa = kappa * (mu_a * qa - (c1 + c2 * s.m) * s.e);
  const Vec3 wb = kappa * (mu_b * qb - (c1 + c2 * s.m) * s.e);
  const Vec3 y = kappa / s.l * (along_a * pa + along_b * pb);
  const Real rolled =
      kappa * kappa * (c1 * pa.squaredNorm() + c1 * pb.squaredNorm() + 2 * c2 * pa.dot(pb));

  const Vec9 stretch = std::sqrt(r.axial * r.length) * strain_gradient(r, s);
  const Vec3 gv = stretch.head<3>(), ga = stretch.segment<3>(3), gb = stretch.tail<3>();
  const Vec3 twist = std::sqrt(r.torsion) * s.twist_axis;
  const Real ll = s.l * s.l, string = n / s.l;
  const Vec3 z = (along_a * s.ca + along_b * s.cb) / ll + string / 2 * s.e;
  const Mat3 vv = (qa * s.ca.transpose() + qb * s.cb.transpose()) / ll - z * s.e.transpose() -
                  s.e * z.transpose() + gv * gv.transpose();
  k.vv = plus_diagonal(vv, (mu_a * along_a + mu_b * along_b) / ll + string);
  const Vec3 va = qa / s.l, vb = qb / s.l;
  k.va = va * pa.transpose() - y * s.e.transpose() + gv * ga.transpose() +
         along_a / s.l * cross_matrix(s.ca);
  k.vb = vb * pb.transpose() - y * s.e.transpose() + gv * gb.transpose() +
         along_b / s.l * cross_matrix(s.cb);
  const auto own = [&](const Vec3& c, const Vec3& w, const Vec3& g) {
    const Vec3 side = w + rolled / 2 * s.e;
    const Mat3 m = side * s.e.transpose() + s.e * side.transpose() - c1 * c * c.transpose() +
                   twist * twist.transpose() + g * g.transpose();
    return plus_diagonal(m, c1);
  };
  k.aa = own(s.ca, wa, ga);
  k.bb = own(s.cb, wb, gb);
  const Mat3 ab = (wa + rolled * s.e) * s.e.transpose() + s.e * wb.transpose() -
                  c2 * s.cb * s.ca.transpose() - twist * twist.transpose() + ga * gb.transpose();
  k.ab = plus_diagonal(ab, c2 * s.m);
}

void hessian(const ElementRest& r, const ElementState& s, Mat9& k) {
  const ScalarGradient d = scalar_gradient(r, s);
  const Real nl = s.tension * r.length / 30;
  const Real up = r.bend_1 / 2 + 2 * nl, ur = r.bend_2 - nl;
  const Real mu_a = 1 - s.xa, mu_b = 1 - s.xb;
  const Real ddga = angle_factor_second(s.xa, s.ga, s.dga);
  const Real ddgb = angle_factor_second(s.xb, s.gb, s.dgb);
  const Mat3 I = Mat3::Identity();
  k.setZero();

  const Vec9 gmu_a = tilt_gradient(s, s.ca, 3), gmu_b = tilt_gradient(s, s.cb, 6);
  const Vec9 gm = angle_gradient(s), ge = strain_gradient(r, s);

  // Second derivatives of the energy in its scalars, u v^T for each pair; strain has its own
  // rank-one term. What is added to `half` is added to its mirror image as well.
  Mat9 half;
  const Real pr = s.product;
  const Real aa = 2 * up * s.dga + ur * s.gb * (ddga * pr + 2 * s.dga * mu_b);
  const Real bb = 2 * up * s.dgb + ur * s.ga * (ddgb * pr + 2 * s.dgb * mu_a);
  const Real ab =
      ur * (s.dga * s.dgb * pr + s.dga * s.gb * mu_a + s.ga * s.dgb * mu_b - s.ga * s.gb);
  const Vec9 of_a = aa / 2 * gmu_a + ab * gmu_b - ur * s.dga * s.gb * gm;
  const Vec9 of_b = bb / 2 * gmu_b - ur * s.ga * s.dgb * gm;
  half.noalias() = gmu_a * of_a.transpose();
  half.noalias() += gmu_b * of_b.transpose();
  half.noalias() += r.axial * r.length / 2 * ge * ge.transpose();

  // Curvature of the scalars themselves.
  const auto tilt_curvature = [&](Real c, const Vec3& dir, int block) {
    const Real mu = dir.dot(s.e);
    const Vec3 normal = dir - mu * s.e;
    const Mat3 ep = normal * s.e.transpose();
    k.topLeftCorner<3, 3>() -=
        c / (s.l * s.l) * (ep + ep.transpose() + mu * (I - s.e * s.e.transpose()));
    const Mat3 mixed = -c / s.l * (I - s.e * s.e.transpose()) * cross_matrix(dir);
    k.block<3, 3>(0, block) += mixed;
    k.block<3, 3>(block, 0) += mixed.transpose();
    const Mat3 ec = s.e * dir.transpose();
    k.block<3, 3>(block, block) += c * ((ec + ec.transpose()) / 2 - mu * I);
  };
  tilt_curvature(d.mu_a, s.ca, 3);
  tilt_curvature(d.mu_b, s.cb, 6);
  if (r.curved) {
    const Vec9 gnu_a = tilt_gradient(s, s.na, 3), gnu_b = tilt_gradient(s, s.nb, 6);
    const Real nu_a = s.e.dot(s.na), nu_b = s.e.dot(s.nb);
    half += gmu_a * (nl * ddga * nu_a / 2 * gmu_a - nl * s.dga * gnu_a).transpose();
    half += gmu_b * (nl * ddgb * nu_b / 2 * gmu_b - nl * s.dgb * gnu_b).transpose();
    tilt_curvature(d.nu_a, s.na, 3);
    tilt_curvature(d.nu_b, s.nb, 6);
  }
  k.topLeftCorner<3, 3>() += s.tension / s.l * (I - s.e * s.e.transpose());

  const Mat3 cc = s.cb * s.ca.transpose();
  const Mat3 same = d.m * ((cc + cc.transpose()) / 2 - s.m * I);
  const Mat3 twist = r.torsion * s.twist_axis * s.twist_axis.transpose();
  const Mat3 other = d.m * (s.m * I - cc) - twist;
  k.block<3, 3>(3, 3) += same + twist;
  k.block<3, 3>(6, 6) += same + twist;
  k.block<3, 3>(3, 6) += other;
  k.block<3, 3>(6, 3) += other.transpose();

  // Twist: second derivative along a path of constant spins is d(axis).(spin_b - spin_a).
  Eigen::Matrix<Real, 3, 9> daxis = Eigen::Matrix<Real, 3, 9>::Zero();
  const Real one = std::max(1 + s.m, 1e-3);
  daxis.block<3, 3>(0, 3) = -cross_matrix(s.ca) / one;
  daxis.block<3, 3>(0, 6) = -cross_matrix(s.cb) / one;
  daxis -= s.twist_axis * gm.transpose() / one;
  half.middleRows<3>(6) += d.phi / 2 * daxis;
  half.middleRows<3>(3) -= d.phi / 2 * daxis;
  k += half + half.transpose();
}

void hessian(const ElementRest& r, const ElementState& s, ElementMatrix& k) {
  Mat9 full;
  hessian(r, s, full);
  k.vv = full.block<3, 3>(0, 0);
  k.va = full.block<3, 3>(0, 3);
  k.vb = full.block<3, 3>(0, 6);
  k.aa = full.block<3, 3>(3, 3);
  k.ab = full.block<3, 3>(3, 6);
  k.bb = full.block<3, 3>(6, 6);
}

ElementMass::ElementMass(const ElementRest& r) {
  const Real m = r.mass, L = r.length;
  same = 13 * m / 35;
  other = 9 * m / 70;
  couple_same = 11 * m * L / 210;
  couple_other = -13 * m * L / 420;
  spin_same = m * L * L / 105;
  spin_other = -m * L * L / 140;
  roll_same = r.rotary * L / 3;
  roll_other = r.rotary * L / 6;
}

Mat12 expand(const Mat9& k) {
  Eigen::Matrix<Real, 9, 12> b = Eigen::Matrix<Real, 9, 12>::Zero();
  b.block<3, 3>(0, 0) = -Mat3::Identity();
  b.block<3, 3>(0, 6) = Mat3::Identity();
  b.block<3, 3>(3, 3) = Mat3::Identity();
  b.block<3, 3>(6, 9) = Mat3::Identity();
  return b.transpose() * k * b;
}

Mat12 expand(const ElementMatrix& k) {
  Mat9 m;
  m << k.vv, k.va, k.vb, k.va.transpose(), k.aa, k.ab, k.vb.transpose(), k.ab.transpose(), k.bb;
  return expand(m);
}

Mat12 mass_matrix(const ElementMass& m, const Vec3& e, const Vec3& ta, const Vec3& tb) {
  const Mat3 I = Mat3::Identity(), z = Mat3::Zero();
  const Mat3 roll = I + e * e.transpose(), xa = cross_matrix(ta), xb = cross_matrix(tb);
  Mat12 k;
  k << m.same * I, -m.couple_same * xa, m.other * I, -m.couple_other * xb,  //
      z, m.spin_same * (I - ta * ta.transpose()) + m.roll_same * roll,
      (m.couple_other * xa).transpose(),
      m.spin_other * (ta.dot(tb) * I - tb * ta.transpose()) + m.roll_other * roll,  //
      z, z, m.same * I, m.couple_same * xb,                                         //
      z, z, z, m.spin_same * (I - tb * tb.transpose()) + m.roll_same * roll;
  const Mat12 full = k.selfadjointView<Eigen::Upper>();
  return full;
}

}  // namespace sutura::thread
