// Numbers and units in text. Expected values are the literals that C++ itself reads, so equality is
// exact unless an angle (a product with pi) is involved.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sutura/units.h"

namespace sutura {
namespace {

Real read(std::string_view text, std::string_view unit) {
  std::string error;
  const auto value = parse_quantity(text, unit, error);
  EXPECT_TRUE(value.has_value()) << text << ": " << error;
  return value.value_or(std::numeric_limits<Real>::quiet_NaN());
}

std::string refuse(std::string_view text, std::string_view unit) {
  std::string error;
  EXPECT_FALSE(parse_quantity(text, unit, error).has_value()) << text;
  EXPECT_FALSE(error.empty()) << text;
  return error;
}

TEST(Units, BareNumbersAreSi) {
  EXPECT_EQ(read("30", "Pa"), 30);
  EXPECT_EQ(read("-1.2e-3", "m"), -1.2e-3);
  EXPECT_EQ(read(" +.5 ", "1"), 0.5);
  EXPECT_EQ(read("5.", "s"), 5);
}

TEST(Units, UnitsOfTheScenes) {
  EXPECT_EQ(read("30 kPa", "Pa"), 30e3);
  EXPECT_EQ(read("0.15 mm", "m"), 0.15e-3);
  EXPECT_EQ(read("0.3 mm", "m"), 0.3e-3);
  EXPECT_EQ(read("20 ms", "s"), 0.02);
  EXPECT_EQ(read("800 mN", "N"), 0.8);
  EXPECT_EQ(read("1 g/cm^3", "kg/m^3"), 1000);
  EXPECT_EQ(read("1000 kg/m^3", "kg/m^3"), 1000);
  EXPECT_EQ(read("2 N/mm", "N/m"), 2000);
  EXPECT_EQ(read("0.5 N m", "N m"), 0.5);
  EXPECT_EQ(read("0.5 N*mm", "N m"), 0.5e-3);
  EXPECT_EQ(read("3 1/s", "1/s"), 3);
  EXPECT_EQ(read("3 s^-1", "1/s"), 3);
  EXPECT_EQ(read("3 Hz", "1/s"), 3);
  EXPECT_EQ(read("7 Pa s", "N s/m^2"), 7);
  EXPECT_EQ(read("7 N s/m^2", "Pa s"), 7);
  EXPECT_EQ(read("2 min", "s"), 120);
  EXPECT_EQ(read("30 %", "1"), 0.3);
  EXPECT_EQ(read("3 um", "m"), 3e-6);
  EXPECT_EQ(read("3 \u00b5m", "m"), 3e-6);
  EXPECT_EQ(read("10mm", "m"), 0.01);
  EXPECT_EQ(read("9.81 m/s/s", "m/s^2"), 9.81);
  // One rounding of pi/180 and one of the product.
  EXPECT_NEAR(read("180 deg", "rad"), std::numbers::pi, 1e-15);
  EXPECT_NEAR(read("90 deg/s", "rad/s"), std::numbers::pi / 2, 1e-15);
  EXPECT_EQ(read("1 rad", "1"), 1);
}

TEST(Units, ScaledNumbersAreRoundedOnce) {
  // Every "x mm" must read as exactly the number that "xe-3" reads as.
  for (int i = 1; i < 2000; ++i) {
    const std::string digits = std::to_string(i) + ".7";
    EXPECT_EQ(read(digits + " mm", "m"), *parse_real(digits + "e-3"));
  }
  EXPECT_EQ(read("1e3 mm", "m"), 1);
  EXPECT_EQ(read("1E+3 mm", "m"), 1);
}

TEST(Units, WrongDimensionSaysWhatWasExpected) {
  EXPECT_EQ(refuse("30 mm", "Pa"), "'30 mm' has the wrong unit: expected a unit like Pa");
  EXPECT_EQ(refuse("30 mm", "1"), "'30 mm' has the wrong unit: expected a pure number");
  refuse("1 N", "N m");
  refuse("1 kg/m^2", "kg/m^3");
}

TEST(Units, UnknownUnitsAreRefusedWithTheNearest) {
  EXPECT_NE(refuse("30 kpA", "Pa").find("did you mean 'kPa'"), std::string::npos);
  EXPECT_NE(refuse("1.5abc", "m").find("'abc' is not a unit"), std::string::npos);
  refuse("1 /s", "1/s");
  refuse("1 m/", "m");
  refuse("1 m^", "m");
  refuse("1 m^2.5", "m");
  refuse("1 m^99999999999", "m");
  refuse("1 N/m s", "N/m");
  refuse("1 mmin", "s");
}

TEST(Units, WhatIsNoNumberIsRefused) {
  for (const char* text :
       {"",  " ", "nan", "NaN",   "inf",    "-inf", "infinity", "0x10", "abc",   "-",
        "+", ".", "e5",  "1e999", "-1e999", "1,5",  "1 2",      "--1",  "1.2.3", "1e999 mm"})
    refuse(text, "m");
  EXPECT_NE(refuse("1,5", "m").find("decimal sign is a point"), std::string::npos);
}

TEST(Units, RealsTakeNoUnit) {
  EXPECT_EQ(parse_real("2.5"), 2.5);
  EXPECT_EQ(parse_real("-2.5e3"), -2500);
  for (const char* text : {"", "2.5 m", "2.5x", "nan", "inf", "1e999", "2 3", "0x1"})
    EXPECT_FALSE(parse_real(text).has_value()) << text;
}

TEST(Units, ListsShareTheUnitAtTheirEnd) {
  std::string error;
  EXPECT_EQ(parse_quantities("0 0 5 mm", "m", error), (std::vector<Real>{0, 0, 5e-3}));
  EXPECT_EQ(parse_quantities("1, 2,-3", "m", error), (std::vector<Real>{1, 2, -3}));
  EXPECT_EQ(parse_quantities(" 1\n 2\t3 1/s ", "1/s", error), (std::vector<Real>{1, 2, 3}));
  EXPECT_EQ(parse_quantities("4mm", "m", error), (std::vector<Real>{4e-3}));
  for (const char* text : {"", "mm", "1 2 3 Pa", "1 2 3 mn", "1,,2", "1,2,", ",1", "1 mm 2 mm",
                           "1 nan", "12-3", "1.2.3", "1;2", "1 2 3 m 4", "1 1e999"})
    EXPECT_FALSE(parse_quantities(text, "m", error).has_value()) << text;
}

TEST(Units, ListsSayWhatIsWrong) {
  std::string error;
  EXPECT_FALSE(parse_quantities("1 mm 2 mm 3 mm", "m", error));
  EXPECT_EQ(error, "'1 mm 2 mm 3 mm': one unit, at the end, holds for the whole list");
  EXPECT_FALSE(parse_quantities("1 2 nan", "m", error));
  EXPECT_EQ(error, "'1 2 nan': 'nan' is not a unit");
  EXPECT_EQ(refuse("30 1 kPa", "Pa"), "'30 1 kPa' has more than one number");
  EXPECT_EQ(refuse("30 1", "1"), "'30 1' has more than one number");
  EXPECT_EQ(read("30 1 / s", "1/s"), 30);
  refuse("30 kPa 1", "Pa");
  EXPECT_EQ(refuse("30 40 kPa", "Pa"), "'30 40 kPa' has more than one number");
}

TEST(Units, FormattedNumbersReadBackTheSame) {
  for (const Real value :
       {0.0, -0.0, 1.0, 0.1, 1.0 / 3, 2e-308, 5e-324, 1.7976931348623157e308, -30e3}) {
    const auto back = parse_real(format_real(value));
    ASSERT_TRUE(back.has_value()) << format_real(value);
    EXPECT_EQ(*back, value);
    EXPECT_EQ(std::signbit(*back), std::signbit(value));
  }
  EXPECT_EQ(format_real(0.1), "0.1");
}

TEST(Units, PlainNumbersAreWrittenAsPeopleDo) {
  EXPECT_EQ(plain_number(100000), "100000");
  EXPECT_EQ(plain_number(-3), "-3");
  EXPECT_EQ(plain_number(0.5), "0.5");
  EXPECT_EQ(plain_number(1e300), "1e+300");
}

}  // namespace
}  // namespace sutura
