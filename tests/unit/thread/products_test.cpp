// The tables of threads and needles against the reference sheets, and what is said of bad text.
#include "products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "csv.h"

namespace sutura::thread {
namespace {

using sutura::testing::reference;
using sutura::testing::Table;

/// "silk braided 2-0" -> "2-0 silk"; "PDS (polydioxanone) 2-0" -> "2-0 PDS".
std::string as_bought(const std::string& name) {
  const std::string size = name.substr(name.rfind(' ') + 1);
  std::string material = name.substr(0, name.rfind(' '));
  for (const char* word : {" braided", " (polydioxanone)"})
    if (const auto at = material.find(word); at != std::string::npos)
      material.erase(at, std::string(word).size());
  return size + ' ' + material;
}

TEST(Products, ThreadsAreThoseOfTheSheet) {
  const Table d01 = reference("d01_threads.csv");
  ASSERT_GE(d01.rows.size(), 9u);
  for (std::size_t i = 0; i < d01.rows.size(); ++i) {
    const std::string name = as_bought(d01.text(i, "thread"));
    std::string error;
    const auto t = find_thread(name, error);
    ASSERT_TRUE(t) << name << ": " << error;
    EXPECT_NEAR(t->diameter, 1e-3 * d01.number(i, "diameter mm"), 1e-12) << name;
    EXPECT_NEAR(t->density, d01.number(i, "density"), 1e-9) << name;
    // The product of all four is what the sheet lists; ten digits of it.
    const Real EI = t->young * t->bending_factor * std::numbers::pi * std::pow(t->diameter, 4) / 64;
    EXPECT_NEAR(EI, d01.number(i, "EI N m2"), 1e-8 * EI) << name;
  }
}

TEST(Products, NeedlesAreThoseOfTheSheet) {
  const Table d02 = reference("d02_needles.csv");
  ASSERT_GE(d02.rows.size(), 5u);
  for (std::size_t i = 0; i < d02.rows.size(); ++i) {
    const std::string full = d02.text(i, "needle");
    const std::string name = full.substr(0, full.find(" ("));
    std::string error;
    const auto n = find_needle(name, error);
    ASSERT_TRUE(n) << name << ": " << error;
    EXPECT_NEAR(n->length, 1e-3 * d02.number(i, "arc length mm"), 1e-12) << name;
    EXPECT_NEAR(n->length / n->angle, 1e-3 * d02.number(i, "radius mm"), 1e-10) << name;
    EXPECT_NEAR(n->diameter, 1e-3 * d02.number(i, "wire diameter mm"), 1e-12) << name;
  }
}

TEST(Products, BothOrdersAndStraightNeedles) {
  std::string error;
  const auto a = find_needle("17 mm 3/8 circle", error), b = find_needle("3/8 circle 17 mm", error);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->angle, b->angle);
  EXPECT_EQ(a->length, b->length);
  const auto straight = find_needle("20 mm straight", error);
  ASSERT_TRUE(straight);
  EXPECT_EQ(straight->angle, 0);
  // Between 19 mm (0.55) and 26 mm (0.65).
  EXPECT_NEAR(straight->diameter, (0.55 + 0.1 / 7) * 1e-3, 1e-12);
  EXPECT_TRUE(find_thread("4-0 Polypropylene", error));
}

struct Bad {
  const char* text;
  const char* words;
};

TEST(Products, BadThreadsAreExplained) {
  for (const auto& [text, words] :
       {Bad{"4-0 polypropilene", "did you mean 'polypropylene'?"},
        Bad{"4/0 nylon", "did you mean '4-0'?"}, Bad{"9-0 nylon", "there is 6-0, 5-0, 4-0"},
        Bad{"nylon", "as in '4-0 polypropylene'"}, Bad{"", "as in '4-0 polypropylene'"},
        Bad{"4-0 catgut", "there is polypropylene"}}) {
    std::string error;
    EXPECT_FALSE(find_thread(text, error)) << text;
    EXPECT_NE(error.find(words), std::string::npos) << text << " -> " << error;
  }
}

TEST(Products, BadNeedlesAreExplained) {
  for (const auto& [text, words] :
       {Bad{"26 mm half circle", "3/8"}, Bad{"26 1/2 circle", "as in '26 mm 1/2 circle'"},
        Bad{"26 mm 2/8 circle", "there is 1/4, 3/8, 1/2, 5/8"}, Bad{"5 mm 1/2 circle", "13 mm"},
        Bad{"-26 mm 1/2 circle", "13 mm"}, Bad{"nan mm 1/2 circle", "nan"},
        Bad{"26 N 1/2 circle", "N"}, Bad{"26 mm 1/2 circle 3", "as in '26 mm 1/2 circle'"}}) {
    std::string error;
    EXPECT_FALSE(find_needle(text, error)) << text;
    EXPECT_NE(error.find(words), std::string::npos) << text << " -> " << error;
  }
}

}  // namespace
}  // namespace sutura::thread
