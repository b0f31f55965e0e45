// Saving and restoring a simulation of toys: what is put back, and what is refused before anything
// is changed.
#include <random>

#include "sutura/archive.h"
#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

constexpr const char* falling = "<Mass name='m'/><Mass name='n'/><Pin name='p' mass='/n'/>";

TEST(State, GoesOnAsIfNothingHadBeen) {
  const World w(falling), other(falling);
  ASSERT_TRUE(w.simulation && other.simulation) << w.messages();
  for (int i = 0; i < 5; ++i) w.simulation->step();
  const std::vector<std::byte> middle = w.simulation->save();
  for (int i = 0; i < 5; ++i) w.simulation->step();
  const std::vector<std::byte> end = w.simulation->save();

  EXPECT_EQ(other.simulation->restore(middle), "");
  EXPECT_EQ(other.simulation->report().step, 5);
  EXPECT_EQ(other.simulation->save(), middle);
  for (int i = 0; i < 5; ++i) other.simulation->step();
  EXPECT_EQ(other.simulation->save(), end);

  // And back again in the simulation that has gone on.
  EXPECT_EQ(w.simulation->restore(middle), "");
  for (int i = 0; i < 5; ++i) w.simulation->step();
  EXPECT_EQ(w.simulation->save(), end);
}

TEST(State, AnotherSceneIsRefusedAndNothingIsChanged) {
  const World w(falling), other("<Mass name='m'/>");
  ASSERT_TRUE(w.simulation && other.simulation);
  w.simulation->step();
  other.simulation->step();
  const std::vector<std::byte> before = other.simulation->save();
  EXPECT_NE(other.simulation->restore(w.simulation->save()).find("another scene"),
            std::string::npos);
  EXPECT_EQ(other.simulation->save(), before);
}

TEST(State, TheDurationIsNoPartOfTheScene) {
  Registry registry;
  registry.component<Mass>("Mass");
  Diagnostics diagnostics;
  std::vector<std::unique_ptr<Simulation>> simulations;
  for (const char* head : {"duration='1 s'", "", "dt='0.1 s'", "dt='0.2 s'"}) {
    auto scene = load_scene_text("<sutura version='1' " + std::string(head) + "><Mass/></sutura>",
                                 "test.xml", ".", registry, diagnostics);
    ASSERT_TRUE(scene);
    simulations.push_back(Simulation::compile(std::move(scene), ".", diagnostics));
  }
  EXPECT_EQ(simulations[1]->restore(simulations[0]->save()), "");
  EXPECT_NE(simulations[3]->restore(simulations[2]->save()), "");
}

TEST(State, DamageIsFoundBeforeAnythingIsChanged) {
  const World w(falling);
  ASSERT_TRUE(w.simulation);
  w.simulation->step();
  const std::vector<std::byte> good = w.simulation->save();
  w.simulation->step();
  const std::vector<std::byte> now = w.simulation->save();
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<std::byte> bad = good;
    const std::size_t bit = random() % (8 * bad.size());
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_NE(w.simulation->restore(bad), "") << bit;
  }
  EXPECT_EQ(w.simulation->save(), now);
}

TEST(State, AComponentThatForgetsSomethingIsNamed) {
  const World w("<Mass name='m' forgetful='true'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  w.simulation->step();
  const std::string problem = w.simulation->restore(w.simulation->save());
  EXPECT_NE(problem.find("/m: more was saved than is known"), std::string::npos) << problem;
}

TEST(State, WhatAComponentRefusesWhileItIsReadChangesNothing) {
  const World w("<Mass name='m'/><Mass name='n' refuses_before='3'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  w.simulation->step();
  w.simulation->step();
  const std::vector<std::byte> young = w.simulation->save();
  w.simulation->step();
  w.simulation->step();
  const std::vector<std::byte> now = w.simulation->save();
  EXPECT_EQ(w.simulation->restore(young), "/n: it is too young");
  EXPECT_EQ(w.simulation->save(), now);
  EXPECT_EQ(w.simulation->step().step, 5);
}

TEST(State, WhatCannotBeUndoneEndsTheSimulation) {
  const World w("<Mass name='m'/><Mass name='n' refuses_before='9'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  w.simulation->step();
  const std::string problem = w.simulation->restore(w.simulation->save());
  EXPECT_NE(problem.find("/n: it is too young; nor could it be undone"), std::string::npos)
      << problem;
  EXPECT_TRUE(w.simulation->report().failure);
  EXPECT_EQ(w.simulation->step().step, 1);
}

}  // namespace
}  // namespace sutura::toys
