// Many equal threads on a device, each pulled by a hand through a path that stays where it is: the
// kernels of batch.cl and batch_solve.cl and what they need.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "program.h"

namespace sutura::opencl {

/// What all of them are. docs/theory/opencl.md has the equations.
struct ThreadsProblem {
  Real dt = 0.01;               ///< s
  Vec3 gravity = Vec3::Zero();  ///< m/s^2
  Index beams = 100;
  Real length = 0.1, diameter = 0.2e-3;             ///< m
  Real young = 2e9, poisson = 0.4, density = 1140;  ///< Pa, 1, kg/m^3
  Vec3 start = Vec3::Zero();                        ///< free end at rest, m
  Vec3 direction = Vec3::UnitX();                   ///< from there to the hand; not zero
  std::vector<Real> path;    ///< three numbers per point, from the free end to the hand, m
  Real lateral = 200;        ///< of a point of the path, across it, N/m
  Real friction = 0.01;      ///< of a point, N
  Real hand = 1000;          ///< grip, N/m
  Real hand_turning = 1e-3;  ///< grip, N m/rad

  static constexpr Index most_points = 60;  ///< their matrix lies in 32 kB of local memory
  Index points() const { return static_cast<Index>(path.size()) / 3; }
  /// What is wrong with it, in a sentence, or empty.
  std::string problem() const;
};

/// The struct Problem of batch.cl.
struct ThreadsNumbers {
  Real dt, length, axial, bend_1, bend_2, torsion;
  Real same, other, couple_same, couple_other, spin_same, spin_other, roll_same, roll_other;
  Real hand, hand_turning, lateral, friction;
  Real gravity[3], hand_axis[4];
};

/// All calls throw DeviceError.
class Threads {
 public:
  /// They are at rest. The device has double precision, the problem nothing wrong.
  Threads(const Device& device, const ThreadsProblem& problem, Index environments);
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  Index environments() const { return environments_; }
  /// Numbers per environment: force of the hand (3, N), friction at the points (N), residual of the
  /// friction (N; NAN once a step could not be solved), positions of the nodes (3 each, m).
  Index observations() const { return 4 + points_ + 3 * (beams_ + 1); }
  /// Back to rest where `which` is not zero; all of them if it is empty.
  void reset(std::span<const std::uint8_t> which);
  /// `velocities` of the hands (m/s, 3 per environment). dt: of this step and those to come.
  void step(std::span<const Real> velocities, Real dt);
  void observe(std::span<Real> out);
  /// Everything that a step leaves to the next, as it lies on the device.
  std::vector<std::uint8_t> state() const;
  void set_state(const std::vector<std::uint8_t>& state);

 private:
  const Device& device_;
  Index environments_, beams_, points_;
  std::size_t state_bytes_;
  Program program_;
  Buffer problem_{device_}, path_{device_}, rest_{device_}, which_{device_}, velocities_{device_},
      states_{device_}, works_{device_}, observations_{device_};
  ThreadsNumbers numbers_;
  std::vector<std::uint8_t> host_which_;
};

}  // namespace sutura::opencl
