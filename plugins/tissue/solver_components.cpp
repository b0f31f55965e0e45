#include "solver_components.h"

#include <charconv>

#include "sutura/registry.h"

namespace sutura::tissue {
namespace {

const std::vector<std::string> backend_words{"auto", "cholmod", "eigen"};

FactorBackend chosen(BackendChoice choice, const Component& who, Setup& setup) {
  if (choice == BackendChoice::automatic) return default_backend();
  const FactorBackend backend =
      choice == BackendChoice::cholmod ? FactorBackend::cholmod : FactorBackend::eigen;
  if (has_backend(backend)) return backend;
  setup.error(who, "backend=\"cholmod\" is not part of this build; use \"auto\" or \"eigen\"");
  return default_backend();
}

template <class T>
void describe_backend(Describe<T>& d) {
  d.attribute("backend", &T::backend, backend_words,
              "Factorisation: CHOLMOD's supernodal one (GPL) where it is built in, or Eigen's.");
}

template <class T>
void describe_outputs(Describe<T>& d) {
  d.output("iterations", "1", "Conjugate gradient iterations of the step.",
           [](const T& s) { return static_cast<Real>(s.report().iterations); });
  d.output("residual", "1", "Worst relative residual |b - A x| / |b| of the step.",
           [](const T& s) { return s.report().residual; });
  d.output("factor_age", "1", "Steps since the matrix behind the factor in use.",
           [](const T& s) { return static_cast<Real>(s.report().factor_age); });
  d.output("adopted_at", "1", "Step at which the factor in use was adopted.",
           [](const T& s) { return static_cast<Real>(s.report().adopted_at); });
  d.output("failed_factors", "1", "Factorisations that failed so far.",
           [](const T& s) { return static_cast<Real>(s.report().failed_factors); });
  d.output("message", "", "What went wrong in the step; empty if nothing did.",
           [](const T& s) { return s.report().message; });
}

}  // namespace

void DirectSolver::describe(Describe<DirectSolver>& d) {
  d.summary(
      "Factorises the matrix of a tissue in every step. Exact; the cost grows fast with nodes.");
  describe_backend(d);
  describe_outputs(d);
}

void DirectSolver::initialise(Setup& setup) {
  set_backend(chosen(backend, *this, setup));
  set_cache(setup.resources.cache);
}

void AsyncPreconditioner::describe(Describe<AsyncPreconditioner>& d) {
  d.summary(
      "Conjugate gradients on the matrix of the step, preconditioned by a factor of an earlier one "
      "that a worker makes while the simulation runs on.");
  d.theory(
      "P^-1 = Q F0^-1 Q^T with F0 the factorised matrix and Q the rotation of the material around "
      "each node since then. An old factor costs iterations, never accuracy.");
  d.attribute(
      "lag", &AsyncPreconditioner::lag,
      "When a new factor is adopted: \"free\", as soon as it is there, or a number of steps "
      "after its snapshot, for runs that repeat bit by bit.");
  d.attribute(
      "tolerance", &AsyncPreconditioner::tolerance, "1", strictly_between(0, 1),
      "Smallest relative residual |b - A x| / |b| that is asked for. The iteration stops earlier, "
      "at up to 0.5, where that is enough for the tolerance of the step.");
  d.attribute("max_iterations", &AsyncPreconditioner::max_iterations, between(1, 1000000),
              "Iterations after which the matrix of the step is factorised at once.");
  d.attribute("refactor_iterations", &AsyncPreconditioner::refactor_iterations, between(0, 1000000),
              "A step that needed more iterations asks for a new factor.");
  d.attribute("max_age", &AsyncPreconditioner::max_age, between(1, 1000000),
              "Age in steps that no factor should reach: at three quarters of it a new one is "
              "asked for, whatever the iterations.");
  describe_backend(d);
  d.link("device", &AsyncPreconditioner::device,
         "Conjugate gradients run there instead of on the CPU, and the matrix of corotational tets "
         "is "
         "made there; the factors are still made here. For thousands of nodes, see "
         "docs/theory/opencl.md.")
      .named_only();
  describe_outputs(d);
}

void AsyncPreconditioner::initialise(Setup& setup) {
  AsyncOptions o;
  o.resources = setup.resources;
  o.backend = chosen(backend, *this, setup);
  o.tolerance = tolerance;
  o.max_iterations = max_iterations;
  o.refactor_iterations = refactor_iterations;
  o.max_age = max_age;
  if (lag != "free") {
    const char* end = lag.data() + lag.size();
    const auto [rest, problem] = std::from_chars(lag.data(), end, o.lag);
    if (problem != std::errc() || rest != end || o.lag < 0)
      setup.error(*this, "lag=\"" + lag + "\": expected \"free\" or a number of steps, 0 or more");
  }
  if (device && o.backend == FactorBackend::eigen)
    setup.error(*this,
                "a device needs the factors of CHOLMOD (backend=\"cholmod\"), which have "
                "supernodes");
  if (device && !device->claim())
    setup.error(*this,
                "another AsyncPreconditioner has this device already; it takes an OpenClDevice of "
                "its own, which may stand for the same GPU");
  set_options(o);
  set_device(device.get());
}

void enrol_tissue_solvers(Registry& registry) {
  registry.component<DirectSolver>("DirectSolver");
  registry.component<AsyncPreconditioner>("AsyncPreconditioner");
}

}  // namespace sutura::tissue
