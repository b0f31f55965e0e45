#include "opencl_device.h"

#include <type_traits>

namespace sutura::opencl {

void OpenClDevice::describe(Describe<OpenClDevice>& d) {
  d.summary(
      "A GPU or another OpenCL device. A solver that names it in its attribute 'device' computes "
      "there; nothing else changes.");
  d.theory(
      "GaussSeidel makes sweeps and direct steps on it, AsyncPreconditioner makes the matrix and "
      "runs "
      "its conjugate gradients on it. Both still "
      "decide on the CPU, in double precision and with the laws themselves, when a problem is "
      "solved. `sutura describe --devices` lists the devices of a machine. docs/theory/opencl.md "
      "says how it works and from which size on it pays.");
  d.attribute("device", &OpenClDevice::device,
              "Part of the name of the device, as in \"H200\"; empty: any.");
  d.attribute("type", &OpenClDevice::type, {"any", "gpu", "cpu", "accelerator"},
              "What kind of device.");
  d.attribute("index", &OpenClDevice::index, between(0, 1000),
              "Which one of those of this name and type, in the order of the list.");
  d.attribute(
      "precision", &OpenClDevice::precision, {"auto", "double", "mixed", "single"},
      "double: everywhere; mixed: matrices in single precision, sums in double; single: for "
      "devices that have nothing else; auto: double where the device has it.");
  d.attribute(
      "on_failure", &OpenClDevice::on_failure, {"stop", "cpu"},
      "Where there is no such device, it is lost, or it cannot do what is asked (a law that "
      "it does not know): the run stops, or the CPU takes over in the same step.");
  d.output("used", "", "Name of the device; empty where the CPU has taken over.",
           [](const OpenClDevice& c) {
             return c.device_ && !c.lost_ ? c.device_->name() : std::string();
           });
  d.output("message", "", "Why the CPU has taken over; empty if it has not.",
           [](const OpenClDevice& c) { return c.why_not_; });
}

void OpenClDevice::initialise(Setup& setup) {
  try {
    device_ = std::make_unique<Device>(DeviceChoice{device, type, index});
    in_use_ = choose(precision, *device_);
    sweeps_ = std::make_unique<Sweeps>(*device_, in_use_);
    gradients_ = std::make_unique<Gradients>(*device_, in_use_);
  } catch (const DeviceError& e) {
    why_not_ = e.what();
    lost_ = true;
    if (on_failure == OnFailure::stop)
      setup.error(*this, why_not_ + "; on_failure=\"cpu\" would let the CPU do its work",
                  Category::plugin);
    else
      setup.warning(*this, why_not_ + "; the CPU does its work", Category::plugin);
  }
}

template <class Work>
bool OpenClDevice::attempt(const Work& work) {
  if (lost_) return false;
  try {
    if constexpr (std::is_void_v<decltype(work())>) {
      work();
      why_not_.clear();
    } else {
      why_not_ = work();
    }
  } catch (const DeviceError& e) {
    device_->drain();  // of what was lent to it before it failed
    lost_ = true;
    why_not_ = e.what();
  }
  if (why_not_.empty()) return true;
  if (on_failure == OnFailure::stop) throw DeviceError(why_not_);
  why_not_ += "; the CPU has taken over";
  return false;
}

bool OpenClDevice::load(const ConstraintProblem& problem) {
  return attempt([&] { return sweeps_->load(problem); });
}

bool OpenClDevice::sweep(ConstraintProblem& problem, std::span<const std::uint32_t> orders) {
  return attempt([&] { sweeps_->sweep(problem, orders); });
}

bool OpenClDevice::solve_tangents(const TangentSystem& system, TangentAnswer& answer) {
  return has_double_sums(in_use_) && attempt([&] { sweeps_->solve_tangents(system, answer); });
}

bool OpenClDevice::set_matrix(const NodeMatrixView& A, std::span<const char> fixed) {
  return attempt([&] { gradients_->set_matrix(A, fixed); });
}

bool OpenClDevice::set_elements(const TetElementsView& tets, const NodeMatrixView& pattern,
                                std::span<const char> fixed) {
  return attempt([&] { gradients_->set_elements(tets, pattern, fixed); });
}

bool OpenClDevice::set_viscosity(const VecX& moved, Real share) {
  return attempt([&] { gradients_->set_viscosity(moved, share); });
}

bool OpenClDevice::assemble(const VecX& moved, Real scale, const VecX& diagonal, VecX& force,
                            std::vector<Mat3>& rotations) {
  return attempt([&] { gradients_->assemble(moved, scale, diagonal, force, rotations); });
}

bool OpenClDevice::element_force(const VecX& moved, VecX& force) {
  return attempt([&] { gradients_->element_force(moved, force); });
}

bool OpenClDevice::read_matrix(std::span<Real> values) {
  return attempt([&] { gradients_->read_matrix(values); });
}

bool OpenClDevice::set_factor(const SupernodalFactor& factor) {
  return attempt([&] { gradients_->set_factor(factor); });
}

bool OpenClDevice::set_turns(std::span<const Mat3> turns) {
  return attempt([&] { gradients_->set_turns(turns); });
}

bool OpenClDevice::find_turns(std::span<const Mat3> of_factor) {
  return attempt([&] { gradients_->find_turns(of_factor); });
}

bool OpenClDevice::keep(const Eigen::Ref<const MatX>& x, Index next) {
  return attempt([&] { gradients_->keep(x, next); });
}

bool OpenClDevice::solve(const Eigen::Ref<const VecX>& b, Eigen::Ref<VecX> x, Real tolerance,
                         Index max_iterations, ConjugateGradientDevice::Report& report) {
  return attempt([&] { report = gradients_->solve(b, x, tolerance, max_iterations); });
}

bool OpenClDevice::entries_of_inverse(std::span<const Index> rows, std::span<const Index> columns,
                                      Eigen::Ref<MatX> entries) {
  return attempt([&] { gradients_->entries_of_inverse(rows, columns, entries); });
}

bool OpenClDevice::add_compliance(const KnownCompliance& known, const SparseRows& rows, Real scale,
                                  Eigen::Ref<MatX> W) {
  return attempt([&] { gradients_->add_compliance(known, rows, scale, W); });
}

}  // namespace sutura::opencl
