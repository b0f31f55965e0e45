// From the tree to flat lists: who is set up when, and what is refused.
#include <algorithm>

#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

TEST(Compile, ComponentsComeAfterThoseTheyLinkTo) {
  const World w(
      "<LatePin name='second' mass='/m' after='/first'/><Pin name='first' mass='/m'/>"
      "<Mass name='m'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  EXPECT_EQ(log(), (Log{"initialise /m", "initialise /first", "initialise /second"}));
}

TEST(Compile, BodiesStayInDocumentOrder) {
  const World w("<Mass name='b'/><Mass name='a'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  ASSERT_EQ(w.simulation->bodies().size(), 2u);
  EXPECT_EQ(w.simulation->bodies()[0].path, "/b");
  EXPECT_EQ(w.simulation->bodies()[1].path, "/a");
}

TEST(Compile, EachSourceHasAKeyOfItsOwn) {
  const World w("<Mass name='m'/><Pin name='p'/><LatePin name='q' after='/p'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  EXPECT_NE(w.get<Pin>("/p").id, w.get<Pin>("/q").id);
  EXPECT_GT(w.get<Pin>("/p").id, 0);
}

TEST(Compile, WhatLeansOnSomethingBrokenIsLeftAlone) {
  const World w("<Broken name='b'/><Leaning name='l'/>");
  EXPECT_FALSE(w.simulation);
  EXPECT_EQ(w.diagnostics.errors(), 1u) << w.messages();
  EXPECT_NE(w.messages().find("[/b] it does not work"), std::string::npos) << w.messages();
  EXPECT_TRUE(log().empty());
}

TEST(Compile, ASecondSolverIsRefused) {
  const World w("<GaussSeidel name='one'/><GaussSeidel name='two'/>");
  EXPECT_FALSE(w.simulation);
  EXPECT_NE(w.messages().find("at most one"), std::string::npos) << w.messages();
}

TEST(Compile, ASceneWithoutAnythingSteps) {
  const World w("");
  ASSERT_TRUE(w.simulation) << w.messages();
  const StepReport& report = w.simulation->step();
  EXPECT_EQ(report.step, 1);
  EXPECT_EQ(report.rows, 0);
  EXPECT_TRUE(report.finite);
}

}  // namespace
}  // namespace sutura::toys
