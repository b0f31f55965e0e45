// Static friction: contact with dry friction that holds more than it drags. Coulomb's law with one
// of two coefficients:
//
//   at rest:  mu_s, until the slip of a step exceeds a band (stick_slip, m): it breaks away
//   sliding:  mu_k <= mu_s, until the slip of a step is within the band again
//
// Rows and units as in coulomb.h. Between the two levels rest and slip would both be answers, so
// the mode has the level, and the law is Coulomb's within one mode. Break-away is an event, on
// verified forces only; the way back is between steps. The band is a speed (Karnopp 1985: slower is
// not sliding) times the step.
#pragma once

#include "sutura/laws/coulomb.h"

namespace sutura {

struct StaticFriction {
  static constexpr int dim = 3;
  static constexpr const char* name = "static_friction";
  struct Params {
    Real mu_static = 0, mu_kinetic = 0;
    Real compliance = 0;  ///< along the normal, m/N
    Real stick_slip = 0;  ///< m
  };
  /// Set in the mode of a contact that has broken away; the rest of it is a Friction.
  static constexpr Mode sliding = 8;

  static Friction state(Mode mode) { return static_cast<Friction>(mode & ~sliding); }
  static Coulomb::Params level(const Params& p, Mode mode) {
    return {(mode & sliding) != 0 ? p.mu_kinetic : p.mu_static, p.compliance};
  }
  static void project(const Mat3& W, const Vec3& d, const Params& p, Mode& mode, Vec3& lambda) {
    Mode within = 0;
    Coulomb::project(W, d, level(p, mode), within, lambda);
    mode = static_cast<Mode>((mode & sliding) | within);
  }
  static void free_directions(const Vec3& delta, const Params& p, Mode mode, const Vec3& lambda,
                              FreeDirections<3>& free) {
    Coulomb::free_directions(delta, level(p, mode), static_cast<Mode>(state(mode)), lambda, free);
  }
  static bool event(const Params& p, const Vec3& delta, Mode& mode, const Vec3&) {
    const bool breaks_away = (mode & sliding) == 0 && p.mu_kinetic < p.mu_static &&
                             state(mode) == Friction::slip && slips(p, delta);
    if (breaks_away) mode |= sliding;
    return breaks_away;
  }
  static Mode next_mode(const Params& p, const Vec3& delta, Mode mode, const Vec3&) {
    const bool slides = (mode & sliding) != 0 && state(mode) == Friction::slip && slips(p, delta);
    return static_cast<Mode>((slides ? sliding : 0) | static_cast<Mode>(state(mode)));
  }

 private:
  static bool slips(const Params& p, const Vec3& delta) {
    return delta.tail<2>().norm() > p.stick_slip;
  }
};

}  // namespace sutura
