// The end of a step that cannot be solved.
#include "unit/runtime/toys.h"

namespace sutura::toys {
namespace {

/// Says that it is out of balance, and the less the earlier the guess.
class Restless : public Mass {
 public:
  static constexpr const char* interface_name = "Restless";
  static void describe(Describe<Restless>& d) { d.summary("A mass that finds no balance."); }
  Imbalance imbalance(const StepContext& c, const VecX&) override {
    const auto lacks = static_cast<Real>(c.pass);
    return {lacks, lacks};
  }
};

/// Holds it up and from the side, and tells of both in another order once the first pass is over.
class Rail : public Component, public ConstraintSource {
 public:
  static void describe(Describe<Rail>& d) {
    d.summary("Holds a mass.");
    d.link("mass", &Rail::mass, "What it holds.");
  }
  Link<Restless> mass;
  Index id = 0;
  Real side = -1, up = -1;  ///< N, in the last step

  void initialise(Setup& setup) override { id = setup.source_id; }
  void build(const StepContext& context, ConstraintBuilder& builder) override {
    if (context.pass < 2) side_ = add(builder, 0);
    up_ = add(builder, 2);
    if (context.pass >= 2) side_ = add(builder, 0);
  }
  void commit(const StepContext&, const SolvedBlocks& solved) override {
    side = solved.lambda(side_)[0];
    up = solved.lambda(up_)[0];
  }

 private:
  BlockId add(ConstraintBuilder& builder, int axis) {
    const BlockVector<1> gap(mass->x[axis]);
    const BlockId block =
        builder.add<Bilateral<1>>(make_key(id, static_cast<std::uint64_t>(axis)), {}, gap);
    PointJacobian J;
    J.nodes = 1;
    J.coefficients = Mat3::Identity();
    builder.couple(block, *mass, Vec3::Unit(axis).transpose(), J, mass->x);
    return block;
  }
  BlockId side_, up_;
};

// Looked at again, the best guess may have its rows in another order. Each keeps its own force.
TEST(BestGuess, ForcesStayWithTheirBlocks) {
  test::TextWorld w;
  w.registry.component<Restless>("Restless");
  w.registry.component<Rail>("Rail");
  enrol_builtin(w.registry);
  w.load("dt='0.1 s' gravity='0 0 -10' passes='5' substeps='1'",
         "<Restless name='m'/><Rail name='r'/>");
  ASSERT_TRUE(w.simulation) << w.messages();
  EXPECT_FALSE(w.simulation->step().solved);
  EXPECT_EQ(w.simulation->report().worst_imbalance().force, 5);
  // 1 kg at 10 m/s^2, and the tolerance of the solver, 1e-5 of 0.1 N and 0.1 mm.
  EXPECT_NEAR(w.get<Rail>("/r").up, 10, 1e-5);
  EXPECT_NEAR(w.get<Rail>("/r").side, 0, 1e-5);
}

}  // namespace
}  // namespace sutura::toys
