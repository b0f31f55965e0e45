#include "forceps.h"

#include <algorithm>

#include "sutura/geometry/poses.h"
#include "sutura/geometry/rolling.h"
#include "sutura/laws/bilateral.h"
#include "sutura/scene.h"

namespace sutura::tools {
namespace {

// A strand is held at two sections, the points of Gauss's rule between its ends: force and moment
// are those of a grip that is uniform along the strand.
constexpr Real sections[] = {0.21132486540518712, 0.78867513459481288};

// When less than this part of a patch is left between the jaws, it slips out: a corner of a
// triangle cannot bear the whole of the grip.
constexpr Real last_rest = 0.25;

constexpr int links = 32;  // of the line that says where a strand meets others

/// Of the section at s, across the jaws: from its centre to its surface (m).
Vec3 arm_across(const CurveBody& curve, Real s, const Vec3& closing, Configuration c) {
  const Vec3 tangent = curve.tangent(s, c);
  const Vec3 across = closing - closing.dot(tangent) * tangent;
  const Real length = across.norm();
  return curve.radius(s) * (length > 1e-6 ? Vec3(across / length) : Vec3(tangent.unitOrthogonal()));
}

}  // namespace

void Forceps::initialise(Setup& setup) {
  source_id_ = setup.source_id;
  for (const std::string& wrong : {place(), plan()})
    if (!wrong.empty()) {
      setup.error(*this, wrong);
      return;
    }
  for (Component* c : setup.scene->components()) {
    const Target target{dynamic_cast<SegmentedCurve*>(c), dynamic_cast<MeshedSolid*>(c)};
    if (target.curve == nullptr && target.solid == nullptr) continue;
    if (!body_ || body_.get() == &target.body()) targets_.push_back(target);
  }
  if (targets_.empty())
    setup.error(*this, body_ ? "'body' can not be held; expected a thread or a tissue"
                             : "there is no thread and no tissue that could be held");
}

void Forceps::drive(const StepContext& context) {
  if (!update(context)) return;
  pieces_.clear();
  applied_ = {};
  sliding_ = false;
  take_ = holding();
}

void Forceps::take() {
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Index target = static_cast<Index>(i);
    if (targets_[i].solid != nullptr) {
      take_patch(target);
      continue;
    }
    const Pose frame = placed(Configuration::start);
    for (const JawSpace::Stretch& s : look(*targets_[i].curve, Configuration::start, frame))
      take_strand(target, s);
  }
  for (Piece& piece : pieces_) piece.share = 1 / static_cast<Real>(pieces_.size());
  find_flat();
}

void Forceps::find_flat() {
  const Pose frame = placed(Configuration::start);
  std::vector<Strand> strands;
  Real sum = 0, count = 0;
  bool tissue = false;
  for (const Piece& piece : pieces_) {
    const SegmentedCurve* curve = targets_[static_cast<std::size_t>(piece.target)].curve;
    if (curve == nullptr) {
      tissue = true;
      continue;
    }
    for (const Point& p : piece.points) {
      sum += p.height;
      ++count;
    }
    const Real low = piece.points.front().s, high = piece.points.back().s;
    // From section to section and on to the ends of the stretch; what is just outside goes along.
    const Real radius = std::max(curve->radius(low), curve->radius(high));
    const Real beyond = sections[0] / (sections[1] - sections[0]);
    const Real more = beyond * (high - low) + 2 * radius;
    Strand& strand = strands.emplace_back();
    strand.curve = piece.target;
    strand.radius = radius;
    strand.low = std::max(low - more, 0.);
    strand.high = std::min(high + more, curve->length());
    for (int k = 0; k <= links; ++k) {
      const Real s = strand.low + Real(k) / links * (strand.high - strand.low);
      strand.line.push_back(seen_from(frame, curve->point(s, Configuration::start)));
    }
  }
  // Tissue is held where it was taken, and is in the way of any strand.
  flat_ = tissue ? 1 : flattest(strands);
  middle_ = tissue || count == 0 ? 0 : sum / count;
}

Real Forceps::drawn(Real height, Real open) const {
  return open * height + std::max(flat_ - open, 0.) * (height - middle_);
}

void Forceps::take_strand(Index target, const JawSpace::Stretch& stretch) {
  const SegmentedCurve& curve = *targets_[static_cast<std::size_t>(target)].curve;
  const Pose frame = placed(Configuration::start);
  Piece& piece = pieces_.emplace_back();
  piece.target = target;
  piece.place = stretch.middle;
  for (const Real at : sections)
    for (const Real side : {1., -1.}) {
      Point& p = piece.points.emplace_back();
      p.id = next_id_++;
      p.s = stretch.low + at * (stretch.high - stretch.low);
      p.side = side;
      p.part = 0.25;
      p.height = seen_from(frame, curve.point(p.s, Configuration::start)).z();
    }
}

void Forceps::take_patch(Index target) {
  const MeshedSolid& solid = *targets_[static_cast<std::size_t>(target)].solid;
  const Pose frame = placed(Configuration::start);
  const TriangleSurface surface = solid.surface(Configuration::start);
  Piece piece;
  piece.target = target;
  Real area = 0;
  for (Index t = 0; t < surface.size(); ++t) {
    Corners corners = surface.corners(t);
    for (Vec3& c : corners) c = seen_from(frame, c);
    const JawSpace::Part part = space_.part(corners);
    if (!(part.area > 0)) continue;
    area += part.area;
    Point& p = piece.points.emplace_back();
    p.id = next_id_++;
    p.at = solid.on_surface(t, part.weights);
    p.part = part.area;
    p.height = seen_from(frame, solid.position(p.at, Configuration::start)).z();
  }
  if (piece.points.empty()) return;
  for (Point& p : piece.points) p.part /= area;
  pieces_.push_back(std::move(piece));
}

/// `open`: how much of its height over the middle is left to a strand.
void Forceps::begin_step(const Target& target, Real open, Point& p) const {
  const Pose frame = placed(Configuration::start);
  Vec3 at;
  Real height = p.height;
  if (target.curve != nullptr) {
    const Vec3 closing = frame.rotation * Vec3::UnitZ();
    p.start_arm = p.side * arm_across(*target.curve, p.s, closing, Configuration::start);
    height = drawn(p.height, open) + p.start_arm.dot(closing);
    at = target.curve->point(p.s, Configuration::start) + p.start_arm;
  } else {
    at = target.solid->position(p.at, Configuration::start);
  }
  p.anchor.head<2>() = seen_from(frame, at).head<2>() - p.stretch;
  p.anchor.z() = height;
}

Vec3 Forceps::position(const Target& target, const Point& p) const {
  if (target.curve == nullptr) return target.solid->position(p.at, Configuration::current);
  return target.curve->point(p.s, Configuration::current) + p.arm;
}

void Forceps::detect(const StepContext& context) {
  if (context.pass == 0) {
    if (take_) {
      take();
      count_closing(!pieces_.empty(), context.time);
    }
    take_ = false;
    const Real open = still_open(context);
    for (Piece& piece : pieces_)
      for (Point& p : piece.points)
        begin_step(targets_[static_cast<std::size_t>(piece.target)], open, p);
  }
  const Pose frame = placed(Configuration::current);
  const Quat turn = frame.rotation * placed(Configuration::start).rotation.conjugate();
  for (Piece& piece : pieces_) {
    const Target& target = targets_[static_cast<std::size_t>(piece.target)];
    for (Point& p : piece.points) {
      Vec3 rolled = Vec3::Zero();
      if (target.curve != nullptr) {
        const Quat was = target.curve->frame(p.s, Configuration::start).rotation,
                   is = target.curve->frame(p.s, Configuration::current).rotation;
        p.arm = is * (was.conjugate() * p.start_arm);
        // After a whole turn the point is where it was, but the section has rolled in the jaws.
        rolled = roll_against(*target.curve, p.s, was, is, turn * was).whole *
                 (is * Vec3::UnitX()).cross(p.arm);
      }
      p.gap = seen_from(frame, position(target, p) + rolled) - p.anchor;
    }
  }
}

void Forceps::build(const StepContext&, ConstraintBuilder& builder) {
  const Mat3 axes = placed(Configuration::current).rotation.toRotationMatrix().transpose();
  for (Piece& piece : pieces_) {
    const Target& target = targets_[static_cast<std::size_t>(piece.target)];
    for (Point& p : piece.points) {
      const Real share = piece.share / piece.left * p.part;
      const Real compliance = 1 / (stiffness_ * share);
      PointJacobian J;
      if (target.curve != nullptr)
        target.curve->surface_jacobian(p.s, p.arm, J);
      else
        target.solid->jacobian(p.at, J);
      const Vec3 at = position(target, p);
      p.along = builder.add<Bilateral<2>>(make_key(source_id_, 2 * p.id),
                                          {compliance, strength_ * share}, p.gap.head<2>());
      builder.couple(p.along, target.body(), axes.topRows<2>(), J, at);
      p.across = builder.add<Bilateral<1>>(make_key(source_id_, 2 * p.id + 1), {compliance},
                                           p.gap.tail<1>());
      builder.couple(p.across, target.body(), axes.bottomRows<1>(), J, at);
    }
  }
}

void Forceps::commit(const StepContext&, const SolvedBlocks& solved) {
  applied_ = {};
  sliding_ = false;
  const Vec3 centre = placed(Configuration::current).position;
  for (Piece& piece : pieces_) {
    const Target& target = targets_[static_cast<std::size_t>(piece.target)];
    piece.slid = false;
    for (Point& p : piece.points) {
      const Vec3 force = solved.force(p.along) + solved.force(p.across);
      applied_.force += force;
      applied_.moment += (position(target, p) - centre).cross(force);
      p.stretch = p.gap.head<2>();
      if (solved.mode(p.along) == Bilateral<2>::capped) {
        sliding_ = piece.slid = true;
        const Real share = piece.share / piece.left * p.part;
        p.stretch = -solved.lambda(p.along) / (stiffness_ * share);
      }
    }
  }
  follow_strands();
  drop_what_is_out();
}

/// What has not slid is held where it was taken. Taken anew in every step, a strand that leaves the
/// jaws through their faces across 'axis' would be let through by as much as the grip gives way.
void Forceps::follow_strands() {
  const Pose frame = placed(Configuration::current);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (targets_[i].curve == nullptr) continue;
    const auto is_here = [&](const Piece& p) { return p.target == static_cast<Index>(i); };
    if (std::none_of(pieces_.begin(), pieces_.end(), is_here)) continue;
    auto& stretches = look(*targets_[i].curve, Configuration::current, frame);
    // A strand is known by its place: it moves a little from step to step, and others are beside.
    const Real reach = space_.half.head<2>().norm();
    std::erase_if(pieces_, [&](Piece& piece) {
      if (!is_here(piece)) return false;
      const auto nearest =
          std::min_element(stretches.begin(), stretches.end(), [&](const auto& a, const auto& b) {
            return (a.middle - piece.place).norm() < (b.middle - piece.place).norm();
          });
      if (nearest == stretches.end() || (nearest->middle - piece.place).norm() > reach) return true;
      for (std::size_t k = 0; k < piece.points.size() && piece.slid; ++k)
        piece.points[k].s = nearest->low + sections[k / 2] * (nearest->high - nearest->low);
      piece.place = nearest->middle;
      stretches.erase(nearest);
      return false;
    });
  }
}

void Forceps::drop_what_is_out() {
  const Pose frame = placed(Configuration::current);
  std::erase_if(pieces_, [&](Piece& piece) {
    const Target& target = targets_[static_cast<std::size_t>(piece.target)];
    if (target.solid == nullptr) return false;
    std::erase_if(piece.points, [&](const Point& p) {
      const Vec3 at = seen_from(frame, position(target, p));
      return std::abs(at.x()) > space_.half.x() || std::abs(at.y()) > space_.half.y();
    });
    Real left = 0;
    for (const Point& p : piece.points) left += p.part;
    piece.left = left;
    return left < last_rest;
  });
}

void Forceps::archive(Archive& a) {
  archive_jaws(a);
  archive_closings(a);
  a("take", take_);
  a("next_id", next_id_);
  a("sliding", sliding_);
  a("applied", applied_);
  a("flat", flat_);
  a("middle", middle_);
  a.list("pieces", pieces_, [](Archive& each, Piece& piece) {
    each("target", piece.target);
    each("place", piece.place);
    each("share", piece.share);
    each("left", piece.left);
    each.list("points", piece.points, [](Archive& one, Point& p) {
      one("id", p.id);
      one("s", p.s);
      one("side", p.side);
      one("at", p.at);
      one("part", p.part);
      one("height", p.height);
      one("stretch", p.stretch);
    });
  });
  if (!a.restoring()) return;
  for (const Piece& piece : pieces_)
    if (piece.target < 0 || piece.target >= static_cast<Index>(targets_.size()))
      a.fail("forceps that hold a body of another scene");
}

std::string Forceps::end_note() const {
  return closed_in_vain(body_ ? "nothing of 'body' was" : "neither thread nor tissue was");
}

BodyGeometry Forceps::geometry() const {
  BodyGeometry g;
  const Pose frame = placed(Configuration::current);
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    g.points.push_back(at(frame, corner.cwiseProduct(space_.half)));
    for (int axis = 0; axis < 3; ++axis)
      if (!((i >> axis) & 1)) {
        g.connectivity.push_back(i);
        g.connectivity.push_back(i | (1 << axis));
      }
  }
  g.fields = {{"holding [1]", false, 1, std::vector<Real>(8, holding() ? 1 : 0)}};
  return g;
}

void Forceps::describe(Describe<Forceps>& d) {
  d.summary(
      "Jaws that close at stated times on what is between them, a thread, a needle or the surface "
      "of a tissue, and carry it along a track. They hold it with a strength: beyond, a thread "
      "slides through and tissue slips out.");
  d.theory(
      "The space between the open jaws is a box, which goes with the track; they close along "
      "'axis', its third edge. What is in the box when they close is taken: each strand of a "
      "thread is a piece, the triangles of one tissue, cut by the box, are another. Nothing "
      "jumps: what is held stays as thick as it is.\n\n"
      "A strand is held against both jaws at two sections, so that it can neither turn nor roll; "
      "tissue at the centroids of its parts of triangles. Pieces share strength and stiffness "
      "equally, the patches of one tissue by their area. At each point a spring holds the material "
      "where it was taken, seen from the jaws. Along the jaws its force is at most the point's "
      "share of the strength: beyond, the material slides, with that force against it. Across the "
      "jaws it has no limit, as they are hard.\n\n"
      "Jaws with a time of 'closing' bring all strands to their middle at once, each in "
      "proportion to its height, until two are about to touch, or one that turns back between them "
      "is about to touch itself. From there only the mean of their heights goes on to the middle: "
      "they end on each other or side by side, and nothing presses them together. Tissue that is "
      "held keeps the jaws apart: then all stay where they were taken.\n\n"
      "A strand that slides is held where it is between the jaws, by the material that is there "
      "now, with its whole share until its end comes out. Tissue is held at the material that was "
      "taken; what has slipped out is free, and the rest has its share, until less than a quarter "
      "is "
      "left, which slips out at once. The force is a row of the constraint problem, taken at the "
      "end of the step. Jaws do not squeeze, they do not "
      "touch what they do not hold (a Tool does), and they hold nothing in the balance in which a "
      "body begins with 'settle'.");
  d.link("body", &Forceps::body_, "Only this is taken; left out: any thread or tissue.")
      .named_only();
  describe_space(d, "jaws", "jaws", "open jaws");
  d.attribute("strength", &Forceps::strength_, "N", between(1e-15, 1e12),
              "Largest force along the jaws on all that they hold.");
  d.attribute("stiffness", &Forceps::stiffness_, "N/m", between(1e-15, 1e12),
              "Of the grip on all that they hold, up to that force.");
  describe_times(d,
                 "Time in which the jaws close and bring the strands between them to their middle, "
                 "until these lie on each other; 0: they stay where they were taken.");
  d.output("force", "N", "Of the jaws on what they hold, at the end of the last step.",
           [](const Forceps& f) -> Vec3 { return f.applied_.force; });
  d.output("moment", "N m", "Likewise, about their centre.",
           [](const Forceps& f) -> Vec3 { return f.applied_.moment; });
  d.output("pieces", "1", "Number of strands and patches of tissue that they hold.",
           [](const Forceps& f) { return static_cast<Real>(f.pieces_.size()); });
  d.output("sliding", "1", "1 if anything slid in the jaws in the last step, else 0.",
           [](const Forceps& f) -> Real { return f.sliding_ ? 1 : 0; });
  d.output("position", "m", "Of their centre.",
           [](const Forceps& f) -> Vec3 { return f.placed(Configuration::current).position; });
}

}  // namespace sutura::tools
