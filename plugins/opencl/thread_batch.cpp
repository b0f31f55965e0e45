#include "thread_batch.h"

#include "sutura/archive.h"

namespace sutura::opencl {

void ThreadBatch::describe(Describe<ThreadBatch>& d) {
  d.summary(
      "Many equal threads on a device, each pulled by a hand through a path that stays where it "
      "is; for learning, which wants thousands of small problems at once.");
  d.theory(
      "A thread of corotational beams, straight at rest, held at its far end by a spring to the "
      "hand; at every point of the path a spring across it and dry friction along it. One "
      "linearly implicit Euler step per step, friction solved exactly. In a run of the scene all "
      "hands move with 'velocity'; a host moves each of them by the interface of sutura/batch.h. "
      "Observations per environment: force of the hand (3, N), friction at the points (N), "
      "residual of the friction (N; NAN once a step could not be solved), positions of the nodes "
      "(3 each, m). docs/theory/opencl.md says what it leaves out and how far it is off.");
  d.link("device", &ThreadBatch::device_, "Where they are.");
  d.attribute("environments", &ThreadBatch::environments_, between(1, 1e6), "How many.");
  d.attribute("beams", &ThreadBatch::beams_, between(2, 1000), "Of each thread.");
  d.attribute("length", &ThreadBatch::length_, "m", between(1e-4, 10), "Of the thread.");
  d.attribute("diameter", &ThreadBatch::diameter_, "m", between(1e-6, 0.1), "Of the thread.");
  d.attribute("young", &ThreadBatch::young_, "Pa", between(1, 1e13), "Young modulus.");
  d.attribute("poisson", &ThreadBatch::poisson_, "1", between(0, 0.5), "Poisson ratio.");
  d.attribute("density", &ThreadBatch::density_, "kg/m^3", between(1, 1e5), "Of the thread.");
  d.attribute("start", &ThreadBatch::start_, "m", any(), "Free end of the thread at rest.");
  d.attribute("direction", &ThreadBatch::direction_, "1", any(),
              "From the free end to the hand, at rest.");
  d.attribute("path", &ThreadBatch::path_, "m", any(),
              "Points of the path, three numbers each, in the order in which they come from the "
              "free end to the hand; at most 60.")
      .required();
  d.attribute("lateral_stiffness", &ThreadBatch::lateral_, "N/m", between(0, 1e9),
              "Of the tissue across the path, per point.");
  d.attribute("friction", &ThreadBatch::friction_, "N", between(0, 1e3),
              "Largest drag of a point on the thread.");
  d.attribute("hand_stiffness", &ThreadBatch::hand_, "N/m", between(1e-6, 1e9),
              "Of the grip, in translation.");
  d.attribute("hand_rotation_stiffness", &ThreadBatch::hand_turning_, "N m/rad", between(0, 1e6),
              "Of the grip, in rotation; 0 lets the section turn.");
  d.attribute("velocity", &ThreadBatch::velocity_, "m/s", any(),
              "Of all hands, in a run of the scene.");
  d.output("force", "N", "Force of the first hand on its thread.",
           [](const ThreadBatch& b) { return Vec3(b.observed(0), b.observed(1), b.observed(2)); });
  d.output("residual", "N",
           "Largest of all environments: by how much friction misses its law; not a number once "
           "a step could not be solved.",
           [](const ThreadBatch& b) {
             Real largest = 0;
             for (Index e = 0; e < b.environments(); ++e) {
               const Real r =
                   b.observed(e * b.observations() + 3 + static_cast<Index>(b.path_.size()) / 3);
               if (!(r <= largest)) largest = r;
             }
             return largest;
           });
}

ThreadsProblem ThreadBatch::problem(const Setup& setup) const {
  return {.dt = setup.dt,
          .gravity = setup.gravity,
          .beams = beams_,
          .length = length_,
          .diameter = diameter_,
          .young = young_,
          .poisson = poisson_,
          .density = density_,
          .start = start_,
          .direction = direction_,
          .path = path_,
          .lateral = lateral_,
          .friction = friction_,
          .hand = hand_,
          .hand_turning = hand_turning_};
}

void ThreadBatch::initialise(Setup& setup) {
  dt_ = setup.dt;
  const ThreadsProblem all = problem(setup);
  if (const std::string wrong = all.problem(); !wrong.empty()) return setup.error(*this, wrong);
  const Device* device = device_->opened();
  if (device == nullptr)
    return setup.error(*this, "there is no device, and no CPU that takes over", Category::plugin);
  if (!device->has_double())
    return setup.error(
        *this,
        "OpenCL device \"" + device->name() + "\" has no double precision; expected one that has",
        Category::plugin);
  try {
    threads_ = std::make_unique<Threads>(*device, all, environments_);
  } catch (const DeviceError& e) {
    return setup.error(*this, e.what(), Category::plugin);
  }
  const auto count = static_cast<std::size_t>(environments_);
  for (std::size_t e = 0; e < count; ++e)
    for (const Real v : {velocity_.x(), velocity_.y(), velocity_.z()}) velocities_.push_back(v);
  observed_.resize(count * static_cast<std::size_t>(observations()));
}

void ThreadBatch::reset(std::span<const std::uint8_t> which) {
  threads_->reset(which);
  is_observed_ = false;
}

void ThreadBatch::step(std::span<const Real> actions) {
  threads_->step(actions, dt_);
  is_observed_ = false;
}

void ThreadBatch::observe(std::span<Real> out) const {
  threads_->observe(out);
}

Real ThreadBatch::observed(Index at) const {
  if (!is_observed_) threads_->observe(observed_);
  is_observed_ = true;
  return observed_[static_cast<std::size_t>(at)];
}

void ThreadBatch::drive(const StepContext& context) {
  if (!(context.dt > 0)) return;
  threads_->step(velocities_, context.dt);
  is_observed_ = false;
}

void ThreadBatch::archive(Archive& archive) {
  std::vector<std::uint8_t> state = threads_->state();
  const std::size_t size = state.size();
  archive("threads", state);
  if (!archive.restoring() || !archive.ok()) return;
  if (state.size() != size) return archive.fail("the state of other threads");
  threads_->set_state(state);
  is_observed_ = false;
}

}  // namespace sutura::opencl
