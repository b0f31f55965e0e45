#include "contact.h"

#include <limits>

#include "curve_curve.h"
#include "curve_surface.h"
#include "curve_tool.h"
#include "surface_surface.h"
#include "surface_tool.h"
#include "sutura/archive.h"
#include "sutura/laws/bilateral.h"
#include "sutura/laws/coulomb.h"
#include "sutura/laws/static_friction.h"
#include "sutura/laws/unilateral.h"
#include "sutura/passage.h"
#include "sutura/scene.h"
#include "sutura/units.h"

namespace sutura::contact {
namespace {

// A touch that slips slower than this sticks, and may hold by static friction again.
constexpr Real slow = 1e-4;  // m/s
// One that is open by more, of the gap from which on touches are built, may be left out of a pass.
constexpr Real idle = 0.1;

// Friction has the direction of the slip. Where a thread rolls it does not slip, and what a step
// misses of that is taken for slip: it turns friction away from the thread, which gives way along
// itself. So where the thread turns by more than `rolls` in a step, slip is to be known to
// `closely`, both in units of its radius.
constexpr Real rolls = 0.1;
constexpr Real closely = 1e-3;

// A tool that is a mesh touches tissue between its nodes at nodes of its own. On its convex edges
// they are so far apart at most, in units of the mean edge of the tissue.
constexpr Real apart = 0.5;

const NoPlaces nowhere;

}  // namespace

void Contact::describe(Describe<Contact>& d) {
  d.summary(
      "Two partners do not pass through each other and rub: a thread or the surface of a tissue, "
      "and "
      "another, or itself, or a Tool. One Contact says it for one pair.");
  d.theory(
      "Each touch is three rows under Coulomb's law: the gap between the surfaces along their "
      "common normal, and the slip of the step across it. Points, normals and gaps are those of "
      "the end of the step, found anew at every guess; a touch is built before the surfaces meet. "
      "No guess is taken whose way leads one centreline through the other, or through a tool (see "
      "the theory of contact). What a SuturePath holds inside of a tissue is not in contact with "
      "it.");
  d.link("first", &Contact::first_, "A thread; or a tissue, with another or with itself.");
  d.link("second", &Contact::second_,
         "What it touches; left out together with 'tool', it touches itself.")
      .named_only();
  d.link("tool", &Contact::tool_, "A rigid shape that it touches, instead of 'second'.")
      .named_only();
  d.attribute("friction", &Contact::friction_, "1", between(0, 100),
              "Coulomb coefficient of the pair.");
  d.attribute("static_friction", &Contact::static_friction_, "1", between(0, 100),
              "The same at rest, if it is larger: what lies still holds up to it, what slides is "
              "dragged with 'friction'.");
  d.attribute("compliance", &Contact::compliance_, "m/N", between(0, 1e6),
              "By how much the surfaces give way along the normal under a force at one touch; 0: "
              "they are hard. A thread of diameter d gives about 1 / (E d) across. It touches at "
              "its nodes and where it is nearest between them, and each of these gives way on its "
              "own: where several lie within the overlap they bear more together.");
  d.output("force", "N",
           "Of all touches on the first. Of one that touches itself it says nothing: what one side "
           "of a touch gets, the other gives.",
           [](const Contact& c) { return c.force_; });
  d.output("normal_force", "N",
           "Sum of the forces along the normals of all touches, whichever way these look: with how "
           "much the walls of a wound press on each other.",
           [](const Contact& c) { return c.normal_force_; });
  d.output("largest_force", "N", "The largest force along the normal at one touch.",
           [](const Contact& c) { return c.largest_force_; });
  d.output("touches", "1", "Number of touches that carry force.",
           [](const Contact& c) { return Real(c.closed_); });
  d.output("distance", "m",
           "The smallest distance between the surfaces; negative where they overlap.",
           [](const Contact& c) { return c.pair_->distance(); });
}

void Contact::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  if (static_friction_ > 0 && static_friction_ < friction_) {
    setup.error(*this, "'static_friction' is " + format_real(static_friction_) +
                           ", less than 'friction', " + format_real(friction_));
    return;
  }
  pair_ = make_pair(setup);
}

/// The path of this thread through this tissue, or null.
const Passage* find_passage(const Scene& scene, const CurveBody& curve, const SolidBody& solid) {
  for (const Component* c : scene.components())
    if (const auto* passage = dynamic_cast<const Passage*>(c))
      if (&passage->curve() == &curve && &passage->solid() == &solid) return passage;
  return nullptr;
}

std::unique_ptr<Pair> Contact::make_pair(Setup& setup) const {
  if (second_ && tool_) {
    setup.error(*this, "both 'second' and 'tool' are given; expected one of them");
    return nullptr;
  }
  auto* curve = dynamic_cast<SegmentedCurve*>(first_.get());
  auto* solid = dynamic_cast<MeshedSolid*>(first_.get());
  const auto skin = [](const MeshedSolid& of) { return std::make_shared<SolidBoundary>(of); };
  if (tool_ && solid != nullptr && tool_->mesh() != nullptr) {
    const Real longest = apart * mean_edge(solid->surface(Configuration::rest));
    return std::make_unique<SurfaceSurface>(skin(*solid),
                                            std::make_shared<ToolBoundary>(*tool_, longest));
  }
  if (tool_ && solid != nullptr) return std::make_unique<SurfaceTool>(skin(*solid), *tool_);
  if (tool_ && curve != nullptr && tool_->mesh() != nullptr)
    return std::make_unique<CurveSurface>(*curve, std::make_shared<ToolBoundary>(*tool_), nullptr);
  if (tool_ && curve != nullptr) return std::make_unique<CurveTool>(*curve, *tool_);
  Body* const touched = second_ ? second_.get() : first_.get();
  auto* other = dynamic_cast<SegmentedCurve*>(touched);
  auto* other_solid = dynamic_cast<MeshedSolid*>(touched);
  if (curve != nullptr && other != nullptr && !tool_)
    return std::make_unique<CurveCurve>(*curve, *other);
  if (curve != nullptr && other_solid != nullptr && !tool_)
    return std::make_unique<CurveSurface>(*curve, skin(*other_solid),
                                          find_passage(*setup.scene, *curve, *other_solid));
  if (solid != nullptr && other_solid != nullptr && !tool_) {
    const auto own = skin(*solid);
    return std::make_unique<SurfaceSurface>(own, solid == other_solid ? own : skin(*other_solid));
  }
  setup.error(*this, solid != nullptr && other != nullptr && !tool_
                         ? "a thread and a tissue: name the thread as 'first'"
                         : "these two cannot touch; expected as 'first' a thread or tissue and as "
                           "'second' another or nothing, or with a Tool");
  return nullptr;
}

void Contact::ready(Setup& setup) {
  const Real distance = pair_->distance();
  Real rounding = 1e-5;  // m: what a scene that lays one on the other may be off
  if (const auto* curve = dynamic_cast<const CurveBody*>(first_.get()))
    rounding = std::min(rounding, curve->radius(curve->length()) / 4);  // no way is free at half
  if (distance < -rounding)
    setup.error(*this, "the two overlap by " + std::to_string(-distance * 1e3) +
                           " mm at the start; move one of them");
}

SegmentedCurve* Contact::own_curve() const {
  return second_ || tool_ ? nullptr : dynamic_cast<SegmentedCurve*>(first_.get());
}

void Contact::archive(Archive& a) {
  memory_.archive(a);
  a("force", force_);
  a("closed", closed_);
  a("largest_force", largest_force_);
  a("normal_force", normal_force_);
}

void Contact::detect(const StepContext& context) {
  touches_.clear();
  if (context.pass == 0) {
    memory_.begin_step();
    pair_->begin_step();
  }
  pair_->find(keeps_places() ? static_cast<const TouchedPlaces&>(memory_) : nowhere, touches_);
  if (!keeps_places()) drop_beside_nearer();
  memory_.recognise(touches_, *pair_);
}

/// Where a thread is nearest between two nodes, these do not give way beside it.
void Contact::drop_beside_nearer() {
  nearest_.clear();
  for (const Touch& t : touches_)
    if (t.between_nodes) nearest_.push_back(t);
  std::erase_if(touches_, [&](const Touch& t) {
    if (t.between_nodes) return false;
    const Pair::Tolerance near = pair_->tolerance(t);
    return std::any_of(nearest_.begin(), nearest_.end(), [&](const Touch& other) {
      return other.gap < t.gap && std::abs(other.first_place - t.first_place) < 4 * near.first &&
             std::abs(other.second_place - t.second_place) < 2 * near.second;
    });
  });
}

void Contact::build(const StepContext& context, ConstraintBuilder& builder) {
  blocks_.clear();
  if (keeps_places()) keep_what_carries(builder);
  // What the compliance asks for is no overlap that a step has left.
  for (Touch& t : touches_) t.left = std::max(Real(0), t.left - compliance_ * t.pressed);
  for (const Touch& t : touches_) {
    Mat3 axes;  // rows: normal, along the first, across both
    axes.row(0) = t.normal;
    const Vec3 along = t.along - t.along.dot(t.normal) * t.normal;
    const bool is_clear = along.norm() > 1e-3 * t.along.norm();
    axes.row(1) = is_clear ? along.normalized() : t.normal.unitOrthogonal();
    axes.row(2) = t.normal.cross(Vec3(axes.row(1)));
    const Key key = make_key(source_id_, t.id);
    if (has_friction()) {
      // A block that was not there before begins where the touch was last seen.
      Vec3 gap = axes * pair_->slip(t);
      gap.tail<2>() += t.left_over;
      gap[0] = t.gap + t.left;
      blocks_.push_back(
          is_sticky()
              ? builder.add<StaticFriction>(
                    key, {static_friction_, friction_, compliance_, slow * context.dt}, gap, t.mode)
              : builder.add<Coulomb>(key, {friction_, compliance_}, gap, t.mode));
      builder.begin_with<3>(blocks_.back(), t.lambda);
      pair_->couple(t, blocks_.back(), axes, builder);
      const Real radius = t.first_arm.norm();
      const bool slips = StaticFriction::state(builder.known_mode(key, t.mode)) == Friction::slip;
      if (slips && pair_->rolled(t) > rolls * radius)
        builder.keep_within(blocks_.back(), closely * radius);
    } else {
      blocks_.push_back(
          builder.add<Unilateral>(key, {compliance_}, BlockVector<1>(t.gap + t.left), t.mode));
      builder.begin_with<1>(blocks_.back(), BlockVector<1>(t.lambda[0]));
      pair_->couple(t, blocks_.back(), axes.topRows<1>(), builder);
    }
    builder.mark_redundant(blocks_.back());
    builder.may_idle(blocks_.back(), idle * pair_->built_from(t));
    stiffen(context, t, builder);
  }
}

/// Which touches there are goes by the shape of the guess: where strands turn from beside each
/// other to across each other, or one place becomes nearer than another. One that carried force in
/// the pass before stays a touch of this one, at its place: else its force would be gone from one
/// pass to the next, and the one after would bring it back.
void Contact::keep_what_carries(const ConstraintBuilder& builder) {
  memory_.each_missing([&](const ContactMemory::Known& known) {
    if (!(builder.known_force(make_key(source_id_, known.id)) > 0)) return;
    Touch touch;
    if (!pair_->find_again(known.first, known.second, touch)) return;
    touch.id = known.id;
    touch.left_over = known.left_over;
    touch.pressed = known.lambda[0];
    touches_.push_back(touch);
  });
}

/// The force of a touch turns with its normal as one strand shifts along the other, which linear
/// rows do not know: passes would go to and fro where that is stiffer than the bodies. So what the
/// normal resists is said as springs, about the guess: without force there, and gone with the pass.
/// They are between the two strands: held in space, a light thread with a tight knot would neither
/// fall nor swing.
void Contact::stiffen(const StepContext& context, const Touch& t, ConstraintBuilder& builder) {
  const Real force = builder.known_force(make_key(source_id_, t.id));
  if (!(force > 0)) return;
  const auto spring = [&](bool of_first, Real stiffness, const Vec3& along) {
    if (!(stiffness > 0)) return;
    // A name for this pass only: what it carried is not taken on.
    const std::uint64_t pass = static_cast<std::uint64_t>(context.pass & 255);
    const std::uint64_t name = (std::uint64_t{1} << 39) | (t.id << 9) | (pass << 1) | of_first;
    const BlockId block =
        builder.add<Bilateral<1>>(make_key(source_id_, name), {1 / stiffness}, BlockVector<1>(0));
    const Vec3 across = (along - along.dot(t.normal) * t.normal).normalized();
    pair_->couple_shift(t, of_first, block, across, builder);
  };
  spring(false, force * t.first_bend, t.first_tangent);
  spring(true, force * t.second_bend, t.second_tangent);
}

void Contact::commit(const StepContext&, const SolvedBlocks& solved) {
  force_.setZero();
  closed_ = 0;
  largest_force_ = normal_force_ = 0;
  left_overlap_ = 0;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    Touch& t = touches_[i];
    const BlockId block = blocks_[i];
    const Vec3 force = solved.force(block);
    const Real normal = solved.lambda(block)[0];
    force_ += force;
    if (!pair_->sees_left_overlap()) left_overlap_ = std::max(left_overlap_, t.left);
    t.carries = normal > 0;
    closed_ += t.carries;
    largest_force_ = std::max(largest_force_, normal);
    normal_force_ += normal;
    pair_->tell_force(t, force);
    t.mode = solved.mode(block);
    t.lambda = Vec3(normal, 0, 0);
    t.left_over.setZero();
    t.slipped = std::numeric_limits<Real>::infinity();
    if (!has_friction()) continue;
    const Vec2 slip = solved.delta(block).tail<2>();
    t.lambda = solved.lambda(block);
    t.slipped = slip.norm();
    if (StaticFriction::state(t.mode) == Friction::stick) t.left_over = slip;
  }
  memory_.remember(touches_, *pair_);
  went_through_ = pair_->free_way() < 1;
  turns_too_far_ = !pair_->knows_way();
  unseen_overlap_ = pair_->unseen_overlap();
}

std::string Contact::fault() const {
  if (went_through_) return "the step leads the two through each other; take a shorter one";
  if (turns_too_far_)
    return "one of the two turns so far in the step that it may have gone through the other; take "
           "a shorter one";
  if (left_overlap_ > 0)
    return "strands overlap by " + format_real(left_overlap_) +
           " m since a step that was not solved; the next steps take it back";
  if (unseen_overlap_ > 0)
    return "the two overlap by " + format_real(unseen_overlap_) +
           " m where no touch holds them apart; take shorter steps or a finer mesh, and do not "
           "push an end back into its channel";
  return {};
}

}  // namespace sutura::contact
