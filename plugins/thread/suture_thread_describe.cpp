#include "suture_thread.h"

namespace sutura::thread {

void SutureThread::describe(Describe<SutureThread>& d) {
  using T = SutureThread;
  d.summary(
      "Needle and suture thread as one chain of corotational beams: abscissa 0 at the needle tip, "
      "growing "
      "to the end of the thread.");
  d.theory("See docs/theory/thread.md.");

  d.attribute(
      "needle", &T::needle,
      "The needle as one buys it, '17 mm 3/8 circle' or '26 mm straight': length, angle and "
      "diameter, where they are not given here. From 13 to 36 mm; 1/4, 3/8, 1/2 or 5/8.");
  d.attribute(
      "thread", &T::thread,
      "The thread as one buys it, '4-0 polypropylene': diameter, modulus, density and "
      "bending factor, where they are not given here. Sizes 6-0 to 0; polypropylene, nylon, "
      "polydioxanone, silk or polyglactin.");
  d.attribute("needle_length", &T::needle_arc_length, "m", between(0, 1e3),
              "Length of the needle along its arc; 0: thread without needle.");
  d.attribute("needle_angle", &T::needle_angle, "rad", between(0, 6.2),
              "Angle of the needle's arc; 180 deg is a half circle, 0 a straight needle.");
  d.attribute("needle_diameter", &T::needle_diameter, "m", between(1e-6, 1e5),
              "Diameter of the needle's wire.");
  d.attribute("needle_young", &T::needle_young, "Pa", between(1e-3, 1e15),
              "Young modulus of the needle.");
  d.attribute("needle_poisson", &T::needle_poisson, "1", between(0, 0.5),
              "Poisson ratio of the needle.");
  d.attribute("needle_density", &T::needle_density, "kg/m^3", between(1e-12, 1e9),
              "Density of the needle.");
  d.attribute("needle_beams", &T::needle_beams, between(1, 10000), "Beams of the needle.");

  d.attribute("thread_length", &T::thread_length, "m", between(1e-4, 1e5), "Length of the thread.");
  d.attribute("thread_diameter", &T::thread_diameter, "m", between(1e-6, 1e5),
              "Diameter of the thread.");
  d.attribute("thread_young", &T::thread_young, "Pa", between(1e-3, 1e15),
              "Young modulus of the thread.");
  d.attribute("thread_poisson", &T::thread_poisson, "1", between(0, 0.5),
              "Poisson ratio of the thread.");
  d.attribute("thread_density", &T::thread_density, "kg/m^3", between(1e-12, 1e9),
              "Density of the thread.");
  d.attribute(
      "bending_factor", &T::bending_factor, "1", strictly_between(0, 1e6),
      "Bending and torsional stiffness relative to a solid wire of the same modulus: 1 for a "
      "monofilament, about 0.05 for a braid.");
  d.attribute("thread_rest_curvature", &T::thread_rest_curvature, "1/m", between(-1e5, 1e5),
              "Memory of the spool: curvature of the thread at rest, in the plane of the needle.");
  d.attribute("thread_rest_torsion", &T::thread_rest_torsion, "1/m", between(-1e5, 1e5),
              "Torsion of the thread at rest: with a curvature it is a helix.");
  d.attribute("thread_rest_file", &T::thread_rest_file,
              "CSV file with curvature and torsion along the thread at rest, instead of the two "
              "numbers: columns s [mm], curvature [1/m], torsion [1/m]; a row holds from its s, "
              "counted from the needle's end, to the next. A column side_curvature [1/m], across "
              "the other, lays any curve out without twisting the thread.");
  d.attribute("thread_start_file", &T::thread_start_file,
              "CSV file, in the same form, with curvature and torsion of the thread as it is laid "
              "out at the start, instead of thread_direction: wound round a bar, in a loop.");
  d.attribute("thread_beams", &T::thread_beams, between(1, 100000), "Beams of the thread.");

  d.attribute(
      "sampling_angle", &T::sampling_angle, "rad", between(0, 1),
      "Adaptive sampling: a beam of the thread that turns by more is split, down to shortest_beam; "
      "two "
      "that together turn by less than half of it are merged, up to the length that thread_beams "
      "gives. 0: the beams stay as they are.");
  d.attribute("shortest_beam", &T::shortest_beam, "m", between(1e-6, 1e3),
              "Shortest beam of adaptive sampling.");

  d.attribute("tip", &T::tip, "m", between(-1e6, 1e6), "Where the needle tip is at the start.");
  d.attribute("tip_direction", &T::tip_direction, "1", between(-1e6, 1e6),
              "Where the tip points, at 'tip' or at 'entry': the direction in which it advances.");
  d.attribute("needle_centre", &T::needle_centre, "m", between(-1e6, 1e6),
              "Centre of the needle's arc, with tip_angle instead of tip and tip_direction.");
  d.attribute("tip_angle", &T::tip_angle, "rad", between(-100, 100),
              "Where the tip is on its arc, from the lowest point (towards -z) in the sense in "
              "which the needle advances: -90 deg is level with the centre, on the way down.");
  d.attribute("entry", &T::entry, "m", between(-1e6, 1e6),
              "Point at which the tip is to enter, along tip_direction; instead of tip.");
  d.attribute("approach", &T::approach, "m", between(0, 1),
              "How far before 'entry' the tip starts, along the needle's arc.");
  d.attribute(
      "plane_normal", &T::plane_normal, "1", between(-1e6, 1e6),
      "Normal of the needle's plane: turning the needle right-handed about it advances the tip "
      "along the needle's own arc.");
  d.attribute("thread_direction", &T::thread_direction, "1", between(-1e6, 1e6),
              "Direction in which the thread is laid out at the start; 0 0 0: straight on from the "
              "needle's end.");
  d.attribute("thread_bend_radius", &T::thread_bend_radius, "m", between(1e-6, 1e5),
              "Radius of the bend by which the laid out thread turns into thread_direction.");
  d.attribute("clamp", &T::clamp, {"none", "start", "end", "both"},
              "Which end sections are fixed in space, in place and direction.");

  d.attribute("velocity", &T::velocity, "m/s", between(-1e4, 1e4), "Velocity at the start.");
  d.attribute("spin", &T::spin, "rad/s", between(-1e6, 1e6),
              "Angular velocity at the start, about the centre of mass.");
  d.attribute("settle", &T::settles,
              "Start at rest, in balance under weight, loads and holds, instead of as laid out.");

  d.attribute("damping_mass", &T::damping_mass, "1/s", between(0, 1e6),
              "Drag against the world, in proportion to mass.");
  d.attribute("damping_stiffness", &T::damping_stiffness, "s", between(0, 1e6),
              "Viscosity: time by which stress goes with the rate of strain, bend and twist.");
  d.attribute(
      "strength", &T::strength, "N", between(0, 1e6),
      "Tension (see ThreadProbe) at which the thread breaks, at the end of the step and for good, "
      "in the beam with the largest; 0: never. A step in which that bears a tenth more is divided; "
      "if it does so in the shortest part, that is a fault of the step.");
  d.attribute("newton_iterations", &T::newton_iterations, between(1, 100),
              "Linearisations of a step, at least; more follow until the tolerance of the scene is "
              "met.");

  d.output("tip_position", "m", "Position of abscissa 0.",
           [](const T& t) { return t.rod_.poses().front().position; });
  d.output("end_position", "m", "Position of the end of the thread.",
           [](const T& t) { return t.rod_.poses().back().position; });
  d.output("tip_velocity", "m/s", "Velocity of abscissa 0.",
           [](const T& t) { return Vec3(t.rod_.velocity().head<3>()); });
  d.output("energy", "J", "Kinetic plus elastic energy.", [](const T& t) { return t.energy(); });
  d.output("kinetic_energy", "J", "Kinetic energy.",
           [](const T& t) { return t.rod_.kinetic_energy(); });
  d.output("elastic_energy", "J", "Elastic energy.",
           [](const T& t) { return t.rod_.elastic_energy(); });
  d.output("momentum", "kg m/s", "Linear momentum.", [](const T& t) { return t.momentum(); });
  d.output("largest_strain", "1", "Largest axial strain of a beam, by magnitude.",
           [](const T& t) { return t.largest_strain(); });
  d.output("largest_curvature", "1/m", "Largest mean curvature of a beam.",
           [](const T& t) { return t.largest_curvature(); });
  d.output("beams", "1", "Number of beams.",
           [](const T& t) { return static_cast<Real>(t.rod_.beams()); });
  d.output("cuts", "1", "Number of beams that are cut or torn.",
           [](const T& t) { return static_cast<Real>(t.rod_.cuts()); });
}

}  // namespace sutura::thread
