// The consistent mass of a beam applied to velocities, without forming its matrix.
#pragma once

#include "element.h"

namespace sutura::thread {

/// The twelve numbers M (v_a, w_a, v_b, w_b) of one element.
struct MassTimes {
  Vec3 xa, sa, xb, sb;
  MassTimes(const ElementMass& m, const ElementState& s, const Vec3& va, const Vec3& wa,
            const Vec3& vb, const Vec3& wb) {
    const Vec3 ra = wa.cross(s.ta), rb = wb.cross(s.tb);  // velocity of the tangents
    xa = m.same * va + m.other * vb + m.couple_same * ra + m.couple_other * rb;
    xb = m.same * vb + m.other * va - m.couple_same * rb - m.couple_other * ra;
    const Vec3 ta = m.couple_same * va - m.couple_other * vb + m.spin_same * ra + m.spin_other * rb;
    const Vec3 tb =
        -m.couple_same * vb + m.couple_other * va + m.spin_same * rb + m.spin_other * ra;
    const Vec3 la = m.roll_same * wa + m.roll_other * wb, lb = m.roll_same * wb + m.roll_other * wa;
    sa = s.ta.cross(ta) + la + s.e.dot(la) * s.e;
    sb = s.tb.cross(tb) + lb + s.e.dot(lb) * s.e;
  }
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
  const MassTimes p(m, s, v.va, v.wa, v.vb, v.wb);
  return (p.xa.dot(v.va) + p.sa.dot(v.wa) + p.xb.dot(v.vb) + p.sb.dot(v.wb)) / 2;
}

}  // namespace sutura::thread
