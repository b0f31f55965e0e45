// Small scenes drawn at random, written as the XML and the mesh file that the real loader reads: a
// pad of jittered tets in up to two layers, a straight or curved needle at any angle to it, a short
// thread, and a tool that advances, stops, retracts and advances again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_data.h"

namespace sutura::testing {

/// The same scene seen from elsewhere, in another unit of length. Times and forces keep their
/// numbers; a quantity of dimension force^a time^b length^p is multiplied by unit^p. What has mass
/// is force time^2 / length.
struct View {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();  ///< in the new unit
  Real unit = 1;              ///< how many new units a metre is

  Vec3 point(const Vec3& x) const { return unit * (turn * x) + shift; }
  Vec3 direction(const Vec3& d) const { return turn * d; }
};

struct RandomScene {
  std::uint64_t seed = 0;
  Real dt = 0;
  Index steps = 0;
  bool approximate = false;  ///< the tissue answers through an old factor
  Real oblique = 0;          ///< angle between needle and surface at the start (rad)
  bool may_divide = true;    ///< its steps, as where a tip goes through

  /// Anything of the scene follows from the seed.
  explicit RandomScene(std::uint64_t seed);
  /// Writes mesh and scene below `folder` and returns the scene's file.
  std::filesystem::path write(const std::filesystem::path& folder, const View& view = {}) const;

 private:
  void draw_tissue();
  void draw_needle();
  void draw_thresholds();
  void draw_path();
  std::string xml(const View& view, const std::string& mesh_file) const;

  struct Draw;  // the generator of random numbers, only while drawing
  Draw* draw_ = nullptr;

  tissue::MeshData mesh_;
  std::vector<Real> held_;  // nodes of the base
  Real element_ = 0;        // edge of a cell of the mesh (m)
  bool smoothed_ = false, layered_ = false, gravity_ = false;
  Real young_ = 0, poisson_ = 0, damping_ = 0, young2_ = 0;

  Vec3 tip_ = Vec3::Zero(), direction_ = Vec3::Zero(), normal_ = Vec3::Zero(),
       centre_ = Vec3::Zero();
  Real needle_length_ = 0, needle_angle_ = 0, needle_diameter_ = 0, hold_ = 0;
  Index needle_beams_ = 0, thread_beams_ = 0;
  Real thread_length_ = 0, thread_young_ = 0, bending_factor_ = 0;

  Real fp_ = 0, fp2_ = 0, exit_ = 0, fc_ = 0, tip_friction_ = 0;
  Real friction_ = 0, static_friction_ = 0, pressure_ = 0, share_ = 0, viscosity_ = 0,
       stick_speed_ = 0;
  Real spacing_ = 0;
  std::vector<Real> times_, travel_;  // s, m along the needle
  bool smooth_ = false;
};

}  // namespace sutura::testing
