#include "solve/problem_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "solve/gauss_seidel.h"
#include "solve_problems.h"

using namespace sutura;
using namespace sutura::test;

namespace {

const LawOperations* const laws[] = {&law_operations<Bilateral<2>>,
                                     &law_operations<suturing::PathFrictionLaw>};

struct ProblemFile : ::testing::Test {
  // A name of its own: tests run beside each other.
  std::string file = (std::filesystem::temp_directory_path() /
                      ("sutura_problem_file_" + std::to_string(getpid()) + ".problem"))
                         .string();
  ~ProblemFile() override { std::filesystem::remove(file); }
};

TEST_F(ProblemFile, ReplaysToTheSameBits) {
  ConstraintProblem p = stitch({.samples = 30, .pull = 0.3}), q;
  p.lambda.setConstant(0.001);
  ASSERT_EQ(write_problem(p, file), "");
  ASSERT_EQ(read_problem(file, laws, q), "");
  BlockGaussSeidel().solve(p);
  BlockGaussSeidel().solve(q);
  EXPECT_EQ(p.lambda, q.lambda);
  for (std::size_t i = 0; i < p.blocks.size(); ++i) EXPECT_EQ(p.blocks[i].mode, q.blocks[i].mode);
}

TEST_F(ProblemFile, DamagedFilesAreRefused) {
  ASSERT_EQ(write_problem(stitch({.samples = 3}), file), "");
  const auto size = std::filesystem::file_size(file);
  ConstraintProblem q;
  EXPECT_NE(read_problem(file + "x", laws, q), "");
  EXPECT_NE(read_problem(file, std::span(laws).first(1), q).find("path_friction"),
            std::string::npos);
  for (const auto cut : {size - 8, size / 2, std::uintmax_t{20}, std::uintmax_t{3}}) {
    std::filesystem::resize_file(file, cut);
    EXPECT_NE(read_problem(file, laws, q), "") << cut;
  }
  // An absurd size is not allocated.
  ASSERT_EQ(write_problem(stitch({.samples = 3}), file), "");
  {
    std::fstream edit(file, std::ios::in | std::ios::out | std::ios::binary);
    edit.seekp(24);
    const std::int64_t rows = std::int64_t{1} << 60;
    edit.write(reinterpret_cast<const char*>(&rows), sizeof(rows));
  }
  EXPECT_NE(read_problem(file, laws, q), "");
}

}  // namespace
