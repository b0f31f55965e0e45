// Conjugate gradients on a device: the same equations as on the CPU, solved to the same residual.
#include "gradients.h"

#include <Eigen/Geometry>
#include <random>

#include "async_solver.h"
#include "bench/tissue_pad.h"
#include "opencl_device.h"
#include "some_device.h"

namespace sutura::opencl {
namespace {

using bench::Pad;
using tissue::Factor;
using tissue::FactorBackend;

constexpr tissue::Material soft{.young = 1e4, .poisson = 0.45, .density = 1000};

class DeviceGradients : public OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    if (IsSkipped()) return;
    if (!device_->has_double()) GTEST_SKIP() << "no double precision";
    if (!tissue::has_backend(FactorBackend::cholmod)) GTEST_SKIP() << "no supernodes";
  }
};

VecX random_vector(Index size) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<Real> some(-1, 1);
  VecX out(size);
  for (Real& x : out) x = some(random);
  return out;
}

Real difference(const VecX& a, const VecX& b) {
  return (a - b).norm() / b.norm();
}

std::unique_ptr<Factor> factor_of(const Pad& pad, bool rough, std::span<const Index> last = {}) {
  auto factor = tissue::make_factor(
      tissue::make_factor_plan(pad.A.pattern(), pad.fixed, last, FactorBackend::cholmod));
  if (rough) factor->keep_rough();
  EXPECT_TRUE(factor->factorise(pad.A));
  return factor;
}

NodeMatrixView view(const Pad& pad) {
  return {pad.nodes(), pad.A.pattern()->row_start(), pad.A.pattern()->column(), pad.A.values()};
}

// Solved with nothing but the factor. Sizes so that there is one subtree only; subtrees and levels;
// and, with 300 nodes eliminated last, columns of more than one panel.
TEST_F(DeviceGradients, AFactorSolvesAsOnTheCpu) {
  for (const int cells : {2, 9, 14})
    for (const bool rough : {false, true}) {
      SCOPED_TRACE(std::to_string(cells) + (rough ? " rough" : ""));
      Pad pad({cells, cells, 6}, 0.004, soft, 0.01, false);
      pad.assemble();
      std::vector<Index> last;
      for (Index i = pad.nodes() - 300; i < pad.nodes() && cells > 9; ++i) last.push_back(i);
      const auto factor = factor_of(pad, rough, last);
      SupernodalFactor supernodes;
      ASSERT_TRUE(factor->supernodes(supernodes));

      MatX ours = random_vector(3 * pad.nodes());
      const VecX asked = ours.col(0);
      factor->solve(ours);
      Solves solves(*device_, Precision::double_);
      solves.set_factor(supernodes);
      Numbers b(*device_, sizeof(Real)), x(*device_, sizeof(Real));
      Buffer done(*device_);
      std::vector<double> in, out(static_cast<std::size_t>(solves.unknowns()));
      for (const std::int32_t row : supernodes.row_of) in.push_back(asked[row]);
      const std::vector<cl_int> no(4, 0);
      b.write(in);
      x.write(out);
      done.write(no);
      solves.solve(b, x, done);
      x.read(out);
      VecX theirs = VecX::Zero(asked.size());
      for (std::size_t k = 0; k < out.size(); ++k) theirs[supernodes.row_of[k]] = out[k];
      // The condition of A is some thousand; single precision has 6e-8.
      EXPECT_LT(difference(theirs, ours.col(0)), rough ? 1e-4 : 1e-11);
    }
}

// Against solves of the CPU in double precision. Fixed unknowns answer zero; 40 columns are more
// than go at once; sizes as above.
TEST_F(DeviceGradients, EntriesOfTheInverseAreThoseOfTheCpu) {
  for (const int cells : {2, 9, 14})
    for (const bool rough : {false, true}) {
      SCOPED_TRACE(std::to_string(cells) + (rough ? " rough" : ""));
      Pad pad({cells, cells, 6}, 0.004, soft, 0.01, false);
      pad.assemble();
      std::vector<Index> last, columns, rows;
      for (Index i = pad.nodes() - 300; i < pad.nodes() && cells > 9; ++i) last.push_back(i);
      for (Index i = 0; i < 3 * pad.nodes(); i += 3 * pad.nodes() / 40) columns.push_back(i);
      for (Index i = 0; i < 3 * pad.nodes(); i += 2) rows.push_back(i);
      const auto factor = factor_of(pad, rough, last);
      SupernodalFactor supernodes;
      ASSERT_TRUE(factor->supernodes(supernodes));
      MatX exact = MatX::Zero(3 * pad.nodes(), static_cast<Index>(columns.size()));
      for (std::size_t c = 0; c < columns.size(); ++c) exact(columns[c], static_cast<Index>(c)) = 1;
      factor->solve(exact);

      for (const Precision precision : {Precision::double_, Precision::single}) {
        Gradients gradients(*device_, precision);
        gradients.set_matrix(view(pad), pad.fixed);
        gradients.set_factor(supernodes);
        MatX entries(static_cast<Index>(rows.size()), static_cast<Index>(columns.size())), again;
        gradients.entries_of_inverse(rows, columns, entries);
        Real wrong = 0, all = 0;
        for (std::size_t c = 0; c < columns.size(); ++c)
          for (std::size_t r = 0; r < rows.size(); ++r) {
            const Real e = exact(rows[r], static_cast<Index>(c));
            wrong += std::pow(entries(static_cast<Index>(r), static_cast<Index>(c)) - e, 2);
            all += e * e;
          }
        // As for a solve, above.
        const bool digits = !rough && precision == Precision::double_;
        EXPECT_LT(std::sqrt(wrong / all), digits ? 1e-11 : 1e-4);
        again = entries;
        gradients.entries_of_inverse(rows, columns, entries);
        EXPECT_TRUE(entries == again) << "not the same bits";
      }
    }
}

TEST_F(DeviceGradients, SolveTheEquationsToTheTolerance) {
  for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
    Pad pad({8, 7, 5}, 0.004, soft, 0.01, false);
    pad.assemble();
    const auto factor = factor_of(pad, true);
    SupernodalFactor supernodes;
    ASSERT_TRUE(factor->supernodes(supernodes));
    // The matrix has changed since, and the factor has been turned about: eight iterations or so.
    std::vector<Mat3> turns(static_cast<std::size_t>(pad.nodes()), Mat3::Identity());
    for (std::size_t i = 0; i < turns.size(); i += 3)
      turns[i] = Eigen::AngleAxis<Real>(0.1, Vec3::UnitX()).toRotationMatrix();
    pad.A.add_diagonal(pad.mass, 2);

    Gradients gradients(*device_, precision);
    gradients.set_matrix(view(pad), pad.fixed);
    gradients.set_factor(supernodes);
    gradients.set_turns(turns);
    const VecX b = random_vector(3 * pad.nodes());
    VecX x = VecX::Zero(b.size()), again = x;
    const Real tolerance = precision == Precision::double_ ? 1e-10 : 1e-4;
    const auto report = gradients.solve(b, x, tolerance, 200);
    EXPECT_TRUE(report.converged);
    EXPECT_GT(report.iterations, 2);
    EXPECT_LT(report.iterations, 60);

    VecX Ax, free = b;
    pad.A.multiply(x, Ax);
    for (Index i = 0; i < pad.nodes(); ++i)
      if (pad.fixed[static_cast<std::size_t>(i)]) {
        EXPECT_TRUE(x.segment<3>(3 * i).isZero(0));
        Ax.segment<3>(3 * i).setZero();
        free.segment<3>(3 * i).setZero();
      }
    // The residual of the iteration is carried along; a few roundings part it from the true one.
    EXPECT_LT(difference(Ax, free), 2 * tolerance);
    gradients.keep(MatX(b.size(), 0), 0);
    gradients.solve(b, again, tolerance, 200);
    EXPECT_TRUE(x == again) << "not the same bits";
  }
}

// What combines right-hand sides that were solved is known but for what was left of them and the
// shift of the small system; kept for it by another device, it is the same to the bit.
TEST_F(DeviceGradients, StartFromTheBestCombinationOfWhatTheyHaveSolved) {
  for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
    SCOPED_TRACE(static_cast<int>(precision));
    Pad pad({8, 7, 5}, 0.004, soft, 0.01, false);
    pad.assemble();
    const auto factor = factor_of(pad, true);
    SupernodalFactor supernodes;
    ASSERT_TRUE(factor->supernodes(supernodes));
    const std::vector<Mat3> turns(static_cast<std::size_t>(pad.nodes()), Mat3::Identity());
    pad.A.add_diagonal(pad.mass, 2);  // not quite what was factorised
    const auto prepare = [&](Gradients& gradients) {
      gradients.set_matrix(view(pad), pad.fixed);
      gradients.set_factor(supernodes);
      gradients.set_turns(turns);
    };
    Gradients first(*device_, precision), second(*device_, precision);
    for (Gradients* g : {&first, &second}) prepare(*g);

    const Index n = 3 * pad.nodes();
    const bool digits = precision == Precision::double_;
    const Real solved = digits ? 1e-10 : 1e-5, enough = digits ? 1e-8 : 1e-3;
    MatX b = MatX::Zero(n, 8), x = MatX::Zero(n, 8);
    for (Index k = 0; k < 8; ++k) b.col(k) = random_vector(n).array().pow(k % 2 ? 1 : 2);
    for (Index k = 0; k < 8; ++k) b.col(k).segment(k * n / 8, n / 8) *= 3;
    for (Index k = 0; k < 8; ++k)
      EXPECT_TRUE(first.solve(b.col(k), x.col(k), solved, 200).converged);
    // Six are kept, of eight.
    const VecX known = 0.3 * b.col(2) - 2 * b.col(5) + b.col(7), forgotten = b.col(0) - b.col(1);
    VecX answer(n), again(n);
    MatX kept(n, 6);
    kept << x.col(6), x.col(7), x.middleCols(2, 4);
    second.keep(kept, 2);
    for (const VecX* asked : {&known, &forgotten}) {
      const auto report = first.solve(*asked, answer, enough, 200);
      EXPECT_TRUE(report.converged);
      EXPECT_EQ(report.iterations == 0, asked == &known) << report.iterations;
      second.solve(*asked, again, enough, 200);
      EXPECT_TRUE(answer == again) << "not the same bits";
    }
    // With another matrix it begins with the best combination there is.
    pad.A.add_diagonal(pad.mass, 2);
    first.set_matrix(view(pad), pad.fixed);
    const auto report = first.solve(known, answer, solved, 200);
    EXPECT_TRUE(report.converged);
    VecX Ax;
    pad.A.multiply(answer, Ax);
    Real left = 0, size = 0;
    for (Index i = 0; i < pad.nodes(); ++i) {
      if (pad.fixed[static_cast<std::size_t>(i)]) continue;
      left += (Ax - known).segment<3>(3 * i).squaredNorm();
      size += known.segment<3>(3 * i).squaredNorm();
    }
    EXPECT_LT(std::sqrt(left / size), 2 * solved);
  }
}

TEST_F(DeviceGradients, SayWhereTheyDoNotConverge) {
  Pad pad({4, 4, 4}, 0.004, soft, 0.01, false);
  pad.assemble();
  const auto factor = factor_of(pad, true);
  SupernodalFactor supernodes;
  ASSERT_TRUE(factor->supernodes(supernodes));
  const std::vector<Mat3> turns(static_cast<std::size_t>(pad.nodes()), Mat3::Identity());
  pad.A.set_zero();
  pad.A.add_diagonal(pad.mass, -1);  // not positive definite
  Gradients gradients(*device_, Precision::double_);
  gradients.set_matrix(view(pad), pad.fixed);
  gradients.set_factor(supernodes);
  gradients.set_turns(turns);
  const VecX b = random_vector(3 * pad.nodes());
  VecX x = VecX::Zero(b.size());
  EXPECT_FALSE(gradients.solve(b, x, 1e-6, 50).converged);
  EXPECT_TRUE(x.allFinite());
}

/// What a Tissue does, with a tool that moves over it; returns where the nodes end.
VecX run(tissue::AsyncSolver& solver, Index steps, std::vector<std::string>* messages = nullptr) {
  Pad pad({8, 8, 5}, 0.004, soft, 0.01, false);
  solver.analyse(pad.A.pattern(), pad.fixed, {});
  for (Index step = 0; step < steps; ++step) {
    pad.step(solver, step, pad.tool(step, 0.2));
    EXPECT_TRUE(solver.report().converged);
    if (messages != nullptr) messages->push_back(solver.report().message);
  }
  return pad.x;
}

tissue::AsyncOptions exact() {
  tissue::AsyncOptions out;
  out.tolerance = 1e-9;
  out.lag = 3;
  return out;
}

std::unique_ptr<OpenClDevice> lenient() {
  auto out = std::make_unique<OpenClDevice>();
  out->on_failure = OnFailure::cpu;
  Diagnostics diagnostics;
  Setup setup{.diagnostics = diagnostics, .scene_directory = {}, .output_directory = {}};
  out->initialise(setup);
  return out;
}

// Both end within the tolerance of the equations, which is what they may differ by.
TEST_F(DeviceGradients, ATissueMovesAsOnTheCpu) {
  const tissue::AsyncOptions options = exact();
  tissue::AsyncSolver cpu(options), there(options);
  const auto device = lenient();
  there.set_device(device.get());
  std::vector<std::string> messages;
  const VecX ours = run(cpu, 12), theirs = run(there, 12, &messages);
  for (const std::string& m : messages) EXPECT_EQ(m, "");
  const VecX rest = Pad({8, 8, 5}, 0.004, soft, 0.01, false).x;
  EXPECT_GT((ours - rest).norm(), 1e-3);
  EXPECT_LT((ours - theirs).norm(), 1e-6 * (ours - rest).norm());
}

TEST_F(DeviceGradients, TheCpuTakesOverInTheSameStep) {
  const tissue::AsyncOptions options = exact();
  tissue::AsyncSolver cpu(options), there(options);
  const auto device = lenient();
  device->opened()->lose();
  there.set_device(device.get());
  std::vector<std::string> messages;
  const VecX ours = run(cpu, 4), theirs = run(there, 4, &messages);
  EXPECT_TRUE(ours == theirs) << "the CPU would have found other bits";
  for (const std::string& m : messages)
    EXPECT_NE(m.find("the CPU has taken over"), std::string::npos) << m;
}

// With a factor in double precision, to rounding; where the device is lost in between, the CPU
// learns the rest.
TEST_F(DeviceGradients, ATissueLearnsTheComplianceOfTouchedNodesAsOnTheCpu) {
  Pad pad({8, 8, 5}, 0.004, soft, 0.01, false);
  pad.assemble();
  pad.find_rotations();
  std::vector<Index> touched;
  for (Index i = pad.nodes() - 40; i < pad.nodes(); ++i) touched.push_back(i);
  const auto half = std::span(touched).first(20);
  tissue::AsyncSolver cpu(exact()), there(exact());
  const auto device = lenient();
  there.set_device(device.get());
  for (tissue::AsyncSolver* solver : {&cpu, &there}) {
    solver->analyse(pad.A.pattern(), pad.fixed, {});
    solver->prepare(pad.A, pad.rotations, 0);
    EXPECT_EQ(solver->touch(half), 3 * 20);
  }
  EXPECT_EQ(there.report().message, "");
  device->opened()->lose();
  for (tissue::AsyncSolver* solver : {&cpu, &there}) EXPECT_EQ(solver->touch(touched), 3 * 20);
  EXPECT_NE(there.report().message.find("the CPU has taken over"), std::string::npos);
  const MatX ours = cpu.compliance().C, theirs = there.compliance().C;
  ASSERT_EQ(theirs.rows(), 3 * 40);
  EXPECT_LT((theirs - ours).norm(), 1e-11 * ours.norm());
  EXPECT_EQ(theirs, theirs.transpose());
}

}  // namespace
}  // namespace sutura::opencl
