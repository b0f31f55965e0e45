// The consistent mass of a beam applied to velocities, without forming its matrix.
#pragma once

#include "element.h"

namespace sutura::thread {

/// How a node moves: velocity, rate of its section's tangent (spin x tangent), spin.
struct NodeRates {
  Vec3 v, tangent, spin;
};

/// The twelve numbers M (a, b) of one element, and their product with (a, b).
struct MassTimes {
  Vec3 xa, sa, xb, sb;
  Real squared;
  MassTimes(const ElementMass& m, const ElementState& s, const NodeRates& a, const NodeRates& b) {
    xa = m.same * a.v + m.other * b.v + m.couple_same * a.tangent + m.couple_other * b.tangent;
    xb = m.same * b.v + m.other * a.v - m.couple_same * b.tangent - m.couple_other * a.tangent;
    const Vec3 ta = m.couple_same * a.v - m.couple_other * b.v + m.spin_same * a.tangent +
                    m.spin_other * b.tangent;
    const Vec3 tb = -m.couple_same * b.v + m.couple_other * a.v + m.spin_same * b.tangent +
                    m.spin_other * a.tangent;
    const Vec3 la = m.roll_same * a.spin + m.roll_other * b.spin;
    const Vec3 lb = m.roll_same * b.spin + m.roll_other * a.spin;
    const Vec3 ra = la + s.e.dot(la) * s.e, rb = lb + s.e.dot(lb) * s.e;
    sa = s.ta.cross(ta) + ra;
    sb = s.tb.cross(tb) + rb;
    squared = xa.dot(a.v) + xb.dot(b.v) + ta.dot(a.tangent) + tb.dot(b.tangent) + ra.dot(a.spin) +
              rb.dot(b.spin);
  }
  MassTimes(const ElementMass& m, const ElementState& s, const Vec3& va, const Vec3& wa,
            const Vec3& vb, const Vec3& wb)
      : MassTimes(m, s, {va, wa.cross(s.ta), wa}, {vb, wb.cross(s.tb), wb}) {}
};

struct ElementVelocity {
  Vec3 va, wa, vb, wb;
  template <class Vector>
  ElementVelocity(const Vector& v, Index e)
      : va(v.template segment<3>(6 * e)),
        wa(v.template segment<3>(6 * e + 3)),
        vb(v.template segment<3>(6 * e + 6)),
        wb(v.template segment<3>(6 * e + 9)) {}
};

inline Real kinetic(const ElementMass& m, const ElementState& s, const ElementVelocity& v) {
  return MassTimes(m, s, v.va, v.wa, v.vb, v.wb).squared / 2;
}

}  // namespace sutura::thread
