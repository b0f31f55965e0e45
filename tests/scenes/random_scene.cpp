#include "random_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "sutura/units.h"
#include "tissue_meshes.h"

namespace sutura::testing {
namespace {

constexpr Real degree = std::numbers::pi / 180;

std::string text(Real x) {
  return format_real(x);
}
std::string text(const Vec3& v) {
  return text(v.x()) + ' ' + text(v.y()) + ' ' + text(v.z());
}
std::string text(const std::vector<Real>& values) {
  std::string out;
  for (const Real v : values) out += text(v) + ' ';
  return out;
}
std::string attribute(const char* name, const auto& value) {
  return std::string(" ") + name + "=\"" + text(value) + '"';
}

}  // namespace

/// Built on the raw output of the generator: the distributions of the standard library differ from
/// one to the next.
struct RandomScene::Draw {
  std::mt19937_64 random;
  Real real(Real low, Real high) {
    return low + (high - low) * static_cast<Real>(random() >> 11) * 0x1p-53;
  }
  Real log_real(Real low, Real high) { return std::exp(real(std::log(low), std::log(high))); }
  bool one_in(int n) { return random() % static_cast<std::uint64_t>(n) == 0; }
  int whole(int low, int high) {
    return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
  }
};

RandomScene::RandomScene(std::uint64_t the_seed) : seed(the_seed) {
  Draw draw{std::mt19937_64(seed)};
  draw_ = &draw;
  draw_tissue();
  draw_needle();
  draw_thresholds();
  draw_path();
  draw_ = nullptr;
}

void RandomScene::draw_tissue() {
  Draw& d = *draw_;
  const std::array<int, 3> cells{d.whole(3, 4), d.whole(3, 4), 2};
  const Vec3 size(d.real(14e-3, 24e-3), d.real(14e-3, 24e-3), d.real(7e-3, 11e-3));
  element_ = size.z() / cells[2];
  mesh_ = test::kuhn_block(cells, size);
  // Top at z = 0, nowhere two equal angles: a tie between two triangles or tets would be a test of
  // luck.
  for (Vec3& p : mesh_.points) {
    const bool top = p.z() > 0.99 * size.z(), base = p.z() < 0.01 * size.z();
    if (base) held_.push_back(static_cast<Real>(&p - mesh_.points.data()));
    for (int i = 0; i < 3; ++i)
      if (i < 2 || !(top || base))
        p[i] += 0.12 * size[i] / cells[static_cast<std::size_t>(i)] * d.real(-1, 1);
    p -= Vec3(0.5 * size.x(), 0.5 * size.y(), size.z());
  }
  layered_ = !d.one_in(3);
  if (layered_) {  // cells of the lower half; kuhn_block numbers them from below, six tets each
    const std::size_t half = mesh_.tets.size() / 2;
    for (std::size_t e = 0; e < mesh_.tets.size(); ++e) mesh_.region[e] = e < half ? 2 : 1;
  } else {
    mesh_.region.assign(mesh_.tets.size(), 1);
  }
  young_ = d.log_real(8e3, 100e3);
  young2_ = young_ * d.log_real(0.3, 3);
  poisson_ = d.real(0.2, 0.45);
  damping_ = d.one_in(3) ? 0 : d.real(0, 10e-3);
  smoothed_ = d.one_in(4);
  approximate = d.one_in(4);
  gravity_ = d.one_in(2);
}

void RandomScene::draw_needle() {
  Draw& d = *draw_;
  oblique = d.real(30, 90) * degree;
  const Real azimuth = d.real(0, 360) * degree, roll = d.real(-40, 40) * degree;
  const Vec3 ahead(std::cos(azimuth), std::sin(azimuth), 0), aside(-ahead.y(), ahead.x(), 0);
  direction_ = std::cos(oblique) * ahead - std::sin(oblique) * Vec3::UnitZ();
  needle_length_ = d.real(15e-3, 26e-3);
  needle_angle_ = d.one_in(2) ? 0 : d.real(60, 180) * degree;
  needle_diameter_ = d.real(0.4e-3, 0.8e-3);
  // A plane in which the needle turns up again: its normal is the horizontal across, rolled about
  // the needle's axis.
  normal_ = Eigen::AngleAxis<Real>(roll, direction_) * -aside;
  tip_ = Vec3(d.real(-2e-3, 2e-3), d.real(-2e-3, 2e-3), d.real(0.2e-3, 1e-3));
  if (needle_angle_ > 0)
    centre_ = tip_ - needle_length_ / needle_angle_ * direction_.cross(normal_);
  hold_ = d.real(0.6, 0.95) * needle_length_;
  needle_beams_ = d.whole(4, 7);
  thread_beams_ = d.whole(4, 10);
  thread_length_ = d.real(20e-3, 50e-3);
  thread_young_ = d.log_real(5e7, 3e9);
  bending_factor_ = d.one_in(2) ? 1 : d.log_real(0.05, 1);
}

void RandomScene::draw_thresholds() {
  Draw& d = *draw_;
  // Forces on the scale of this tissue: a point load F dents a mesh of edge a by about F / (E a).
  // The dent stays below an element, or the mesh would turn inside out before the tip is through.
  fp_ = young_ * element_ * d.real(0.2e-3, 1.2e-3);
  fp2_ = fp_ * d.log_real(0.5, 2);
  exit_ = fp_ * d.log_real(0.5, 1);
  fc_ = fp_ * d.real(0, 0.9);
  tip_friction_ = d.one_in(3) ? 0 : d.real(0.05, 0.6);
  friction_ = d.real(0.05, 0.5);
  static_friction_ = d.one_in(2) ? 0 : friction_ * d.real(1, 1.6);
  // Such that 5 mm of needle drag with 0.05 to 1 times the puncture force.
  pressure_ = fp_ * d.log_real(0.05, 1) / (friction_ * std::numbers::pi * needle_diameter_ * 5e-3);
  share_ = d.one_in(2) ? 0 : d.real(0, 1);
  // Viscous drag equals dry drag at a speed of 1 to 100 mm/s.
  viscosity_ = d.one_in(2) ? 0 : friction_ * pressure_ / d.log_real(1e-3, 0.1);
  stick_speed_ = d.one_in(2) ? 0 : d.log_real(1e-5, 1e-3);
  spacing_ = d.real(0.5e-3, 1.5e-3);
}

void RandomScene::draw_path() {
  Draw& d = *draw_;
  dt = d.log_real(2e-3, 20e-3);
  smooth_ = d.one_in(2);
  Real far = d.real(4e-3, 8e-3), back = far * d.real(0.1, 1.3), again = far * d.real(0.8, 1.4);
  steps = d.whole(30, 50);
  if (needle_angle_ > 100 * degree &&
      d.one_in(2)) {  // all the way round and out again, if the pad lets it
    far = 0.4 * needle_length_;
    back = 0.3 * far * d.real(0, 1);
    again = 0.9 * needle_length_;
    hold_ = 0.95 * needle_length_;
    steps = 60;
  } else {
    again = std::min(again, 0.5 * needle_length_);
  }
  // Fractions of the script: rest, advance, stop, retract, advance.
  const Real advanced = d.real(0.3, 0.4), stop = advanced + d.real(0.05, 0.12),
             retracted = stop + d.real(0.12, 0.22);
  travel_ = {0, far, far, far - back, again};
  for (const Real f : {0.02, advanced, stop, retracted, 1.})
    times_.push_back(f * dt * static_cast<Real>(steps));
}

std::filesystem::path RandomScene::write(const std::filesystem::path& folder,
                                         const View& view) const {
  const std::string name = "scene" + std::to_string(seed);
  tissue::MeshData mesh = mesh_;
  for (Vec3& p : mesh.points) p = view.point(p);
  test::write_msh(mesh, folder / (name + ".msh"));
  const std::filesystem::path file = folder / (name + ".xml");
  std::ofstream(file) << xml(view, name + ".msh");
  return file;
}

std::string RandomScene::xml(const View& view, const std::string& mesh_file) const {
  const auto length = [&](int power, Real value) {  // a quantity with this power of length
    return value * std::pow(view.unit, power);
  };
  std::vector<Real> positions, rotations;
  for (const Real s : travel_) {
    const Vec3 p =
        needle_angle_ > 0 ? Vec3::Zero() : Vec3(view.unit * view.direction(s * direction_));
    const Vec3 r = needle_angle_ > 0
                       ? Vec3(view.direction(s * needle_angle_ / needle_length_ * normal_))
                       : Vec3::Zero();
    positions.insert(positions.end(), p.data(), p.data() + 3);
    rotations.insert(rotations.end(), r.data(), r.data() + 3);
  }
  // Powers of length: Pa -2, kg/m^3 -4 (force time^2 / length^4), N/m -1, N m/rad 1, 1/Pa 2, Pa s/m
  // -3, m/s and m/s^2 1.
  std::string out =
      std::string("<sutura version=\"1\"") + (may_divide ? "" : " substeps=\"1\"") +
      attribute("dt", dt) +
      attribute("gravity", Vec3(length(1, gravity_ ? 9.81 : 0) * view.direction(-Vec3::UnitZ()))) +
      ">\n";
  for (const char* plugin : {"thread", "tissue", "suturing", "tools"})
    out += std::string("<plugin name=\"") + plugin + "\"/>\n";
  out +=
      "<WatchedSolver/>\n<node name=\"skin\">\n<TetMesh unit=\"m\" file=\"" + mesh_file + "\"/>\n";
  out += approximate ? "<AsyncPreconditioner lag=\"2\"/>\n" : "<DirectSolver/>\n";
  out += "<Tissue" + attribute("young", length(-2, young_)) + attribute("poisson", poisson_) +
         attribute("density", length(-4, 1000)) + attribute("damping_stiffness", damping_) +
         (smoothed_ ? " element=\"smoothed\"" : "") + "/>\n";
  if (layered_)
    out += "<Layer region=\"2\"" + attribute("young", length(-2, young2_)) +
           attribute("poisson", poisson_) + attribute("density", length(-4, 1100)) + "/>\n";
  out += "<Attach" + attribute("nodes", held_) + "/>\n</node>\n";
  out +=
      "<SutureThread name=\"suture\"" + attribute("needle_length", length(1, needle_length_)) +
      attribute("needle_angle", needle_angle_) +
      attribute("needle_diameter", length(1, needle_diameter_)) +
      attribute("needle_young", length(-2, 190e9)) + attribute("needle_density", length(-4, 7850)) +
      attribute("needle_beams", Real(needle_beams_)) +
      attribute("thread_length", length(1, thread_length_)) +
      attribute("thread_diameter", length(1, 0.2e-3)) +
      attribute("thread_young", length(-2, thread_young_)) +
      attribute("thread_density", length(-4, 1000)) + attribute("bending_factor", bending_factor_) +
      attribute("thread_beams", Real(thread_beams_)) + attribute("tip", view.point(tip_)) +
      attribute("tip_direction", view.direction(direction_)) +
      attribute("plane_normal", view.direction(normal_)) +
      attribute("thread_direction", view.direction(Vec3(0.1, 0.2, 1))) +
      attribute("thread_bend_radius", length(1, 5e-3)) + attribute("damping_mass", 1.) +
      attribute("damping_stiffness", 1e-3) + "/>\n";
  out += "<Track" + attribute("centre", view.point(centre_)) + attribute("times", times_) +
         attribute("positions", positions) + attribute("rotations", rotations) +
         (smooth_ ? " easing=\"smooth\"" : "") + "/>\n";
  out += "<Grasper" + attribute("at", length(1, hold_)) + attribute("stiffness", length(-1, 1e6)) +
         attribute("rotation_stiffness", length(1, 10)) + "/>\n";
  out += "<SuturePath name=\"path\"" + attribute("spacing", length(1, spacing_)) +
         attribute("wall_compliance", length(2, 1e-7)) + "/>\n";
  out += "<Cutting" + attribute("threshold", fc_) + "/>\n";
  out += "<PathFriction name=\"friction\"" + attribute("coefficient", friction_) +
         attribute("static_coefficient", static_friction_) +
         attribute("pressure", length(-2, pressure_)) + attribute("lateral_share", share_) +
         attribute("viscosity", length(-3, viscosity_)) +
         attribute("stick_speed", length(1, stick_speed_)) + "/>\n";
  out += "<Puncture" + attribute("threshold", fp_) + attribute("exit_threshold", exit_) +
         attribute("friction", tip_friction_) + attribute("reach", length(1, 1e-3));
  if (layered_)
    out += attribute("regions", std::vector<Real>{2}) +
           attribute("region_thresholds", std::vector<Real>{fp2_});
  return out + "/>\n</sutura>\n";
}

}  // namespace sutura::testing
