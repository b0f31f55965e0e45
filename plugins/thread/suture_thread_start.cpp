// How a thread begins: what its attributes mean together, and the state before the first step.
#include <algorithm>
#include <cmath>

#include "products.h"
#include "rod_static.h"
#include "sutura/units.h"
#include "suture_thread.h"

namespace sutura::thread {

namespace {
constexpr Index most_beams = 200000;  // some 500 MB with the matrices of the step
}

void SutureThread::initialise(Setup& setup) {
  look_up_products(setup);
  if (tip_direction.norm() < 1e-9) setup.error(*this, "tip_direction must not be zero");
  const bool by_centre = says("needle_centre") || says("tip_angle");
  const Real aslant = tip_direction.cross(plane_normal).norm();
  if (plane_normal.norm() < 1e-9 ||
      (!by_centre && aslant < 1e-6 * tip_direction.norm() * plane_normal.norm()))
    setup.error(*this, "plane_normal must not be zero nor parallel to tip_direction");
  const Real shortest_beams = sampling_angle > 0 ? thread_length / shortest_beam : 0;
  if (shortest_beams > most_beams)
    setup.error(*this, "shortest_beam: a thread of " + format_real(thread_length) +
                           " m could be split into more than " + std::to_string(most_beams) +
                           " beams; expected at least " + format_real(thread_length / most_beams) +
                           " m, or a shorter thread");
  if (!setup.ok()) return;
  doubt_sizes(setup);
  if (needle_arc_length == 0)
    setup.warn_without_effect(*this,
                              {"needle_angle", "needle_diameter", "needle_young", "needle_poisson",
                               "needle_density", "needle_beams"},
                              "there is no needle");
  if (thread_direction.isZero(0))
    setup.warn_without_effect(*this, {"thread_bend_radius"}, "'thread_direction' is not given");
  if (settles)
    setup.warn_without_effect(*this, {"velocity", "spin"}, "with 'settle' it begins at rest");
  const TipPlace place = place_needle();
  if (!place.error.empty()) setup.error(*this, place.error);
  const RestShape rest = read_rest(setup);
  std::optional<RestShape> start;
  if (!thread_start_file.path.empty()) {
    if (says("thread_direction"))
      setup.error(*this, "thread_start_file and thread_direction both say how the thread lies");
    start = read_shape(setup, "thread_start_file", thread_start_file);
  }
  if (!setup.ok()) return;
  shape_ = {.needle_length = needle_arc_length,
            .needle_angle = needle_angle,
            .thread_length = thread_length,
            .tip = place.tip,
            .tip_direction = place.direction,
            .plane_normal = plane_normal,
            .thread_direction = thread_direction,
            .thread_bend_radius = thread_bend_radius,
            .thread_rest = rest,
            .thread_start = start};
  build();
}

/// Sizes that are allowed, but more likely a slip of the unit.
void SutureThread::doubt_sizes(Setup& setup) const {
  constexpr Real longest_needle = 0.15, thickest_needle = 3e-3, longest_thread = 10,
                 thickest_thread = 2e-3;  // m
  const auto doubt = [&](const char* attribute, Real value, Real most, const char* known) {
    if (value > most)
      setup.warning(*this, std::string(attribute) + " is " + format_real(value) + " m, and " +
                               known + "; is the unit right?");
  };
  doubt("needle_length", needle_arc_length, longest_needle, "suture needles end at about 100 mm");
  if (needle_arc_length > 0)
    doubt("needle_diameter", needle_diameter, thickest_needle, "needles have up to about 2 mm");
  doubt("thread_length", thread_length, longest_thread, "sutures have up to about 3 m");
  doubt("thread_diameter", thread_diameter, thickest_thread, "the thickest suture has 0.9 mm");
}

/// The tables fill in what the scene does not say itself.
void SutureThread::look_up_products(Setup& setup) {
  const auto fill = [&](const char* attribute, Real& value, Real found) {
    if (!says(attribute)) value = found;
  };
  std::string error;
  if (!needle.empty()) {
    if (const auto product = find_needle(needle, error)) {
      fill("needle_length", needle_arc_length, product->length);
      fill("needle_angle", needle_angle, product->angle);
      fill("needle_diameter", needle_diameter, product->diameter);
    } else {
      setup.error(*this, "needle: " + error);
    }
  }
  if (!thread.empty()) {
    if (const auto product = find_thread(thread, error)) {
      fill("thread_diameter", thread_diameter, product->diameter);
      fill("thread_young", thread_young, product->young);
      fill("thread_density", thread_density, product->density);
      fill("bending_factor", bending_factor, product->bending_factor);
    } else {
      setup.error(*this, "thread: " + error);
    }
  }
}

/// From the centre of the arc or from the point of entry to tip and direction. Attributes stay as
/// the scene has them: written back, it must not place the needle twice.
TipPlace SutureThread::place_needle() const {
  const bool by_tip = says("tip");
  const bool by_centre = says("needle_centre") || says("tip_angle");
  const bool by_entry = says("entry") || says("approach");
  TipPlace place{tip, tip_direction, {}};
  if (by_tip + by_centre + by_entry > 1 || (by_centre && says("tip_direction"))) {
    place.error =
        "the needle is placed twice; expected 'tip' with 'tip_direction', or "
        "'needle_centre' with 'tip_angle', or 'entry' with 'tip_direction'";
    return place;
  }
  const NeedleArc arc{needle_arc_length, needle_angle, plane_normal};
  if (by_centre) {
    if (says("needle_centre") && says("tip_angle"))
      place = place_by_centre(arc, needle_centre, tip_angle);
    else
      place.error = "'needle_centre' and 'tip_angle' go together; one of them is missing";
  } else if (by_entry) {
    if (says("entry"))
      place = place_by_entry(arc, entry, tip_direction, approach);
    else
      place.error = "'approach' needs 'entry', the point that it counts from";
  }
  return place;
}

RestShape SutureThread::read_rest(Setup& setup) {
  if (thread_rest_file.path.empty())
    return RestShape(std::vector<RestPiece>{{0, thread_rest_curvature, thread_rest_torsion}});
  if (says("thread_rest_curvature") || says("thread_rest_torsion"))
    setup.error(*this, "the rest shape is given twice, by thread_rest_file and by a number");
  return read_shape(setup, "thread_rest_file", thread_rest_file);
}

RestShape SutureThread::read_shape(Setup& setup, const char* attribute, const File& from) {
  const std::filesystem::path file = setup.resolve(from.path);
  int line = 0;
  std::string error;
  std::vector<RestPiece> pieces = read_rest_shape(file, line, error);
  if (!pieces.empty()) return RestShape(std::move(pieces));
  // A fault inside the file is shown at its line there; one of the file as a whole, in the scene.
  if (line > 0)
    setup.diagnostics.error({file.string(), line}, path(), error, Category::file);
  else
    setup.error(*this, std::string(attribute) + ": " + error, Category::file);
  return {};
}

Vec3 SutureThread::centre_of_mass() const {
  const std::vector<Pose>& p = rod_.poses();
  Vec3 sum = Vec3::Zero();
  for (Index e = 0; e < rod_.beams(); ++e) {
    // The centroid of the Hermite cubic.
    const ElementRest& r = rod_.element(e);
    const Vec3 bow = p[e].rotation * Vec3::UnitX() - p[e + 1].rotation * Vec3::UnitX();
    sum += r.mass * ((p[e].position + p[e + 1].position) / 2 + r.length / 12 * bow);
  }
  return sum / rod_.mass();
}

void SutureThread::start_moving() {
  if (velocity.isZero(0) && spin.isZero(0)) return;
  const Vec3 centre = centre_of_mass();
  for (Index i = 0; i < rod_.nodes(); ++i) {
    const Vec3 arm = rod_.poses()[i].position - centre;
    rod_.velocity().segment<3>(6 * i) = velocity + spin.cross(arm);
    rod_.velocity().segment<3>(6 * i + 3) = spin;
  }
  for (const Index node : rod_.clamped()) rod_.velocity().segment<6>(6 * node).setZero();
}

std::string SutureThread::settle(const Vec3& gravity) {
  if (!rod_.is_held())
    return "nothing holds this thread at time 0, so it has no balance; clamp it or let a Grasper "
           "hold it";
  // A millionth of what acts; and a nanonewton, about what rounding leaves in a steel needle.
  const Real acting = rod_.mass() * gravity.norm() + load().norm();
  const StaticReport report = equilibrium(rod_, gravity, load(), 1e-9 + 1e-6 * acting);
  for (NodeSpring& spring : rod_.springs())
    if (spring.active) spring.applied = spring.wrench(rod_.poses()[spring.node]);
  if (report.converged) return {};
  return "no balance was found, " + format_real(report.residual) +
         " N are left; lay the thread out closer to where it is to hang";
}

void SutureThread::add_load(Index hold, const Wrench& wrench) {
  const Index i = 6 * rod_.springs()[hold].node;
  load().segment<3>(i) += wrench.force;
  load().segment<3>(i + 3) += wrench.moment;
}

SutureThread::SectionState SutureThread::section_state(Real s) const {
  const Index e = place(rod_, s).beam;
  ElementState state;
  rod_.element_state(e, state);
  const Real tension = tension_of(e, state), beside = tension - state.tension;
  const Vec3 draws = rod_.element(e).length * strain_gradient(rod_.element(e), state).head<3>();
  return {beam_curvature(rod_, e), state.twist / rod_.element(e).length, tension,
          gradient(rod_.element(e), state).v + beside * draws};
}

}  // namespace sutura::thread
