#include <gtest/gtest.h>

#include "base/nearest_name.h"
#include "sutura/diagnostics.h"

namespace sutura {
namespace {

TEST(Diagnostics, TextSaysWhereWhoWhat) {
  const Diagnostic d{Severity::error, Category::scene, {"a.xml", 7}, "/skin/tissue", "no."};
  EXPECT_EQ(d.text(), "a.xml:7: error: [/skin/tissue] no.");
  const Diagnostic w{Severity::warning, Category::file, {"a.xml", 0}, "", "odd."};
  EXPECT_EQ(w.text(), "a.xml: warning: odd.");
}

TEST(Diagnostics, FirstErrorDecidesTheExitCode) {
  Diagnostics d;
  EXPECT_EQ(d.exit_code(), 0);
  d.warning({}, "", "w", Category::plugin);
  EXPECT_TRUE(d.ok());
  EXPECT_EQ(d.exit_code(), 0);
  d.error({}, "", "first", Category::file);
  d.error({}, "", "second", Category::plugin);
  EXPECT_FALSE(d.ok());
  EXPECT_EQ(d.errors(), 2u);
  EXPECT_EQ(d.all().size(), 3u);
  EXPECT_EQ(d.exit_code(), 3);
}

TEST(NearestName, FindsMisspellings) {
  const std::vector<std::string> names{"young", "poisson", "density", "TetMesh", "dt"};
  EXPECT_EQ(nearest_name("yuong", names), "young");  // swapped
  EXPECT_EQ(nearest_name("poison", names), "poisson");
  EXPECT_EQ(nearest_name("tetmesh", names), "TetMesh");  // case is no difference
  EXPECT_EQ(nearest_name("TatMash", names), "TetMesh");  // two letters of seven
  EXPECT_EQ(nearest_name("td", names), "dt");
}

TEST(NearestName, KnowsOtherSpellingsAndOtherPrograms) {
  const std::vector<std::string> names{"young", "poisson", "density", "TetMesh", "tip_direction"};
  EXPECT_EQ(nearest_name("tet-mesh", names), "TetMesh");
  EXPECT_EQ(nearest_name("TIP DIRECTION", names), "tip_direction");
  EXPECT_EQ(nearest_name("youngModulus", names), "young");      // SOFA
  EXPECT_EQ(nearest_name("youngs_modulus", names), "young");    // most finite element codes
  EXPECT_EQ(nearest_name("MeshGmshLoader", names), "TetMesh");  // SOFA
  EXPECT_EQ(nearest_name("timestep", std::vector<std::string>{"gravity", "dt"}), "dt");  // MuJoCo
  EXPECT_EQ(nearest_name("needle_tip_direction", names), "tip_direction");  // one is part of it
  EXPECT_EQ(nearest_name("timestep", names), "");  // the word is known, but not meant here
}

TEST(WhatInstead, KnowsWhatNeedsNoComponentHere) {
  EXPECT_NE(what_instead("FreeMotionAnimationLoop").find("implicit Euler"), std::string::npos);
  EXPECT_NE(what_instead("TriangleCollisionModel").find("<Contact>"), std::string::npos);
  EXPECT_NE(what_instead("BarycentricMapping"), "");
  EXPECT_EQ(what_instead("Tissue"), "");
  EXPECT_EQ(what_instead(""), "");
}

TEST(NearestName, IsSilentWhenNothingIsClose) {
  const std::vector<std::string> names{"young", "poisson", "dt"};
  EXPECT_EQ(nearest_name("colour", names), "");
  EXPECT_EQ(nearest_name("yd", names), "");  // every letter
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'y'), names), "");
  EXPECT_EQ(nearest_name("young", {}), "");
}

}  // namespace
}  // namespace sutura
