#include "threads.h"

#include <cmath>
#include <numbers>

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t group = 64;

constexpr std::size_t padded(std::size_t bytes) {
  return (bytes + 7) / 8 * 8;
}

std::size_t bytes_of_state(std::size_t beams, std::size_t points) {
  return 8 * (13 * (beams + 1) + beams + 3 + points + 1) + padded(4 * (points + 2));
}

std::size_t bytes_of_work(std::size_t beams, std::size_t points) {
  const std::size_t nodes = beams + 1, columns = points + 1;
  return 8 * (84 * beams + 72 * (nodes + beams) + 6 * nodes * columns + points * points +
              2 * points) +
         padded(4 * points);
}

std::string definitions(const ThreadsProblem& p) {
  return "-DBEAMS=" + std::to_string(p.beams) + " -DPOINTS=" + std::to_string(p.points()) +
         " -DGROUP=" + std::to_string(group);
}

Quat section(const ThreadsProblem& p) {
  return Quat::FromTwoVectors(Vec3::UnitX(), p.direction);
}

ThreadsNumbers numbers_of(const ThreadsProblem& p) {
  const Quat section = opencl::section(p);
  // Section, ElementRest and ElementMass of the thread plugin, for a beam that is straight at rest.
  const Real L = p.length / static_cast<Real>(p.beams), radius = p.diameter / 2;
  const Real area = std::numbers::pi * radius * radius, second = area * radius * radius / 4;
  const Real ei = p.young * second, m = p.density * area * L, rotary = p.density * second;
  const Real kappa = 6 * (1 + p.poisson) / (7 + 6 * p.poisson);
  const Real shear = 12 * ei / (kappa * p.young / (2 * (1 + p.poisson)) * area * L * L);
  return {.dt = p.dt,
          .length = L,
          .axial = p.young * area,
          .bend_1 = ei / L * (4 + shear) / (1 + shear),
          .bend_2 = ei / L * (2 - shear) / (1 + shear),
          .torsion = ei / (1 + p.poisson) / L,
          .same = 13 * m / 35,
          .other = 9 * m / 70,
          .couple_same = 11 * m * L / 210,
          .couple_other = -13 * m * L / 420,
          .spin_same = m * L * L / 105,
          .spin_other = -m * L * L / 140,
          .roll_same = rotary * L / 3,
          .roll_other = rotary * L / 6,
          .hand = p.hand,
          .hand_turning = p.hand_turning,
          .lateral = p.lateral,
          .friction = p.friction,
          .gravity = {p.gravity.x(), p.gravity.y(), p.gravity.z()},
          .hand_axis = {section.w(), section.x(), section.y(), section.z()}};
}

/// Each point and the direction of the path there.
std::vector<Real> points_and_tangents(const ThreadsProblem& p) {
  std::vector<Real> out;
  const auto point = [&p](Index k) { return Vec3(Eigen::Map<const Vec3>(&p.path[3 * k])); };
  for (Index k = 0; k < p.points(); ++k) {
    const Index before = std::max<Index>(k - 1, 0), after = std::min(k + 1, p.points() - 1);
    const Vec3 x = point(k),
               along = p.points() == 1 ? p.direction : Vec3(point(after) - point(before));
    const Vec3 t = along / along.norm();
    for (const Real r : {x.x(), x.y(), x.z(), t.x(), t.y(), t.z()}) out.push_back(r);
  }
  return out;
}

/// Positions and rotations of the nodes at rest.
std::vector<Real> rest_of(const ThreadsProblem& p) {
  std::vector<Real> out;
  const Quat q = section(p);
  const Vec3 beam = p.length / static_cast<Real>(p.beams) * p.direction.normalized();
  for (Index i = 0; i <= p.beams; ++i) {
    const Vec3 x = p.start + static_cast<Real>(i) * beam;
    for (const Real r : {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z()}) out.push_back(r);
  }
  return out;
}

/// What a host hands over is one row per environment.
void expect(std::size_t given, Index rows, Index each, const char* what) {
  const auto due = static_cast<std::size_t>(rows * each);
  if (given != due)
    throw DeviceError("a batch was given " + std::to_string(given) + " " + what + "; expected " +
                      std::to_string(due));
}

}  // namespace

std::string ThreadsProblem::problem() const {
  if (!(direction.norm() > 0)) return "'direction' is zero; expected where the thread leads";
  if (path.empty() || path.size() % 3 != 0 || points() > most_points)
    return "'path' has " + std::to_string(path.size()) +
           " numbers; expected three for each of 1 to " + std::to_string(most_points) + " points";
  for (const Real x : points_and_tangents(*this))
    if (!std::isfinite(x))
      return "'path' has no direction at one of its points; expected points that differ";
  return {};
}

Threads::Threads(const Device& device, const ThreadsProblem& p, Index environments)
    : device_(device),
      environments_(environments),
      beams_(p.beams),
      points_(p.points()),
      state_bytes_(
          bytes_of_state(static_cast<std::size_t>(beams_), static_cast<std::size_t>(points_))),
      program_(device, Precision::double_, std::string(programs::batch) + programs::batch_solve,
               definitions(p)),
      numbers_(numbers_of(p)) {
  const auto count = static_cast<std::size_t>(environments);
  const std::vector<Real> path = points_and_tangents(p), rest = rest_of(p);
  path_.write(path);
  rest_.write(rest);
  problem_.write(&numbers_, sizeof(numbers_));
  states_.reserve(count * state_bytes_);
  works_.reserve(
      count * bytes_of_work(static_cast<std::size_t>(beams_), static_cast<std::size_t>(points_)));
  observations_.reserve(count * static_cast<std::size_t>(observations()) * sizeof(Real));
  reset({});
}

void Threads::reset(std::span<const std::uint8_t> which) {
  if (!which.empty()) expect(which.size(), environments_, 1, "flags of what to reset");
  host_which_.assign(static_cast<std::size_t>(environments_), which.empty() ? 1 : 0);
  std::copy(which.begin(), which.end(), host_which_.begin());
  which_.write(host_which_);
  program_["batch_reset"](host_which_.size(), group, which_, rest_, states_,
                          static_cast<cl_int>(environments_));
  device_.finish();
}

void Threads::step(std::span<const Real> velocities, Real dt) {
  expect(velocities.size(), environments_, 3, "numbers of actions");
  const std::size_t items = group * static_cast<std::size_t>(environments_);
  if (dt != numbers_.dt) {
    numbers_.dt = dt;
    problem_.write(&numbers_, sizeof(numbers_));
  }
  velocities_.write(velocities.data(), velocities.size_bytes());
  program_["batch_assemble"](items, group, problem_, path_, velocities_, states_, works_);
  program_["batch_factor"](items, group, states_, works_);
  program_["batch_answer"](items, group, works_);
  program_["batch_friction"](items, group, problem_, path_, states_, works_);
  program_["batch_move"](items, group, problem_, states_, works_);
  device_.finish();
}

void Threads::observe(std::span<Real> out) {
  expect(out.size(), environments_, observations(), "places for observations");
  program_["batch_observe"](static_cast<std::size_t>(environments_), group, problem_, states_,
                            static_cast<cl_int>(environments_), observations_);
  observations_.read(out.data(), out.size_bytes());
}

std::vector<std::uint8_t> Threads::state() const {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(environments_) * state_bytes_);
  states_.read(out);
  return out;
}

void Threads::set_state(const std::vector<std::uint8_t>& state) {
  states_.write(state);
  device_.finish();
}

}  // namespace sutura::opencl
