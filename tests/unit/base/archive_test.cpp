// What is saved comes back to the bit, and what does not fit is refused.
#include "sutura/archive.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "sutura/body.h"

namespace sutura {
namespace {

struct Sample {
  Real depth = 0;
  std::uint8_t mode = 0;
  bool operator==(const Sample&) const = default;
};
enum class Kind : std::uint8_t { none, some };

/// One of everything.
struct Thing {
  Real real = 0;
  Index count = 0;
  int small = 0;
  std::uint64_t word = 0;
  bool flag = false;
  Kind kind = Kind::none;
  std::string text;
  Vec3 vector = Vec3::Zero();
  Pose pose;
  Wrench wrench;
  EmbeddedPoint point;
  VecX column;
  MatX matrix;
  std::vector<Index> list;
  std::vector<Mat3> rotations;
  std::vector<Sample> samples;

  void archive(Archive& a) {
    a("real", real);
    a("count", count);
    a("small", small);
    a("word", word);
    a("flag", flag);
    a("kind", kind);
    a("text", text);
    a("vector", vector);
    a("pose", pose);
    a("wrench", wrench);
    a("point", point);
    a("column", column);
    a("matrix", matrix);
    a("list", list);
    a("rotations", rotations);
    a.list("samples", samples, [](Archive& each, Sample& s) {
      each("depth", s.depth);
      each("mode", s.mode);
    });
  }
};

Thing full() {
  Thing t;
  t.real = 0.1;
  t.count = -7;
  t.small = 3;
  t.word = std::numeric_limits<std::uint64_t>::max();
  t.flag = true;
  t.kind = Kind::some;
  t.text = std::string("a\0b", 3);
  t.vector = Vec3(1, 2, std::numeric_limits<Real>::quiet_NaN());
  t.pose = {Vec3(1, 2, 3), Quat(0.5, -0.5, 0.5, 0.5)};
  t.wrench = {Vec3(1, 0, 0), Vec3(0, -0.0, 1)};
  t.point = {4, {0.1, 0.2, 0.3, 0.4}};
  t.column = VecX::LinSpaced(5, 0, 1);
  t.matrix = VecX::LinSpaced(12, -1, 1).reshaped(3, 4);
  t.list = {3, 1, 4};
  t.rotations = {Mat3::Identity(), Mat3::Constant(1.0 / 3)};
  t.samples = {{1.5, 2}, {2.5, 3}};
  return t;
}

std::vector<std::byte> saved(Thing t) {
  Archive a;
  t.archive(a);
  EXPECT_TRUE(a.ok());
  return a.bytes();
}

TEST(Archive, GivesBackTheSameBits) {
  const std::vector<std::byte> bytes = saved(full());
  Thing t;
  t.list.assign(100, 0);  // sizes are those that were saved
  Archive a(bytes);
  t.archive(a);
  EXPECT_TRUE(a.finished()) << a.problem();
  EXPECT_EQ(saved(t), bytes);
  EXPECT_EQ(t.samples, full().samples);
  EXPECT_EQ(t.text, full().text);
  EXPECT_EQ(t.matrix, full().matrix);
}

TEST(Archive, NothingAtTheEndIsSomething) {
  Archive save;
  std::vector<Sample> none;
  MatX flat(0, 3);
  const auto each = [](Archive& a, Sample& s) { a("depth", s.depth); };
  save("flat", flat);
  save.list("none", none, each);
  std::vector<Sample> samples(2);
  MatX matrix(5, 5);
  Archive a(save.bytes());
  a("flat", matrix);
  a.list("none", samples, each);
  EXPECT_TRUE(a.finished()) << a.problem();
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(matrix.rows(), 0);
  EXPECT_EQ(matrix.cols(), 3);
}

TEST(Archive, RefusesAnotherNameAnotherTypeAnotherShape) {
  Archive save;
  Real x = 1;
  Vec3 v(1, 2, 3);
  save("x", x);
  save("v", v);
  const auto problem_of = [&](const auto& restore) {
    Archive a(save.bytes());
    restore(a);
    return a.problem();
  };
  EXPECT_EQ(problem_of([&](Archive& a) { a("y", x); }), "expected 'y', found 'x'");
  EXPECT_EQ(problem_of([&](Archive& a) {
              Index i = 5;
              a("x", i);
              EXPECT_EQ(i, 5);
            }),
            "expected 'x', found 'x' of another type");
  EXPECT_EQ(problem_of([&](Archive& a) {
              Vec6 w;
              a("x", x);
              a("v", w);
            }),
            "'v' has the wrong shape");
  EXPECT_EQ(problem_of([&](Archive& a) {
              a("x", x);
              a("v", v);
              a("z", x);
            }),
            "the state ends too early");
}

TEST(Archive, ReadsNothingAfterTheFirstMismatch) {
  Archive save;
  Real x = 1, y = 2;
  save("x", x);
  save("y", y);
  Archive a(save.bytes());
  Real other = 7;
  a("other", other);
  a("y", other);
  EXPECT_EQ(other, 7);
  EXPECT_EQ(a.problem(), "expected 'other', found 'x'");
}

// Cut anywhere, or with any byte changed, it reads or refuses, and never past the end: the
// sanitizers watch. Sizes that are made up do not allocate more than the bytes could hold.
TEST(Archive, SurvivesTruncationAndNoise) {
  const std::vector<std::byte> good = saved(full());
  for (std::size_t n = 0; n < good.size(); ++n) {
    Archive a{std::span(good).first(n)};
    Thing t;
    t.archive(a);
    EXPECT_FALSE(a.ok()) << n;
  }
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> noisy = good;
    for (int k = 0; k < 3; ++k) noisy[random() % noisy.size()] = static_cast<std::byte>(random());
    Archive a(noisy);
    Thing t;
    t.archive(a);
    EXPECT_LE(t.list.size(), good.size());
    EXPECT_LE(static_cast<std::size_t>(t.matrix.size()), good.size());
  }
}

}  // namespace
}  // namespace sutura
