#include "track.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "key_frame_file.h"
#include "key_frames.h"
#include "sutura/archive.h"
#include "sutura/units.h"

namespace sutura::tools {
namespace {

/// `part` of the way from one pose to another at constant speed along a screw. Unlike a straight
/// way of one of the points, it is the same wherever a scene has its origin.
Pose on_screw(const Pose& from, const Pose& to, Real part) {
  Quat turn = to.rotation * from.rotation.conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1;  // the shorter way round
  const Eigen::AngleAxis<Real> whole(turn);
  const Real angle = whole.angle();
  const Vec3& axis = whole.axis();
  const Vec3 way = to.position - from.position;
  const Vec3 along = way.dot(axis) * axis;
  // Across the axis a point goes along an arc; this is the chord of the part.
  const Real chord = angle > 0 ? std::sin(part * angle / 2) / std::sin(angle / 2) : part;
  const Eigen::AngleAxis<Real> half((part - 1) * angle / 2, axis);
  const Vec3 across = chord * (half * Vec3(way - along));
  return {from.position + part * along + across,
          Quat(Eigen::AngleAxis<Real>(part * angle, axis)) * from.rotation};
}

}  // namespace

void Track::describe(Describe<Track>& d) {
  d.summary(
      "The motion of a tool over time, from key frames written in the scene or read from a CSV "
      "file. Before the first key and after the last the tool rests.");
  d.theory(
      "At time *t* the track moves a point *x* of the tool to *centre + R(t) (x - centre) + "
      "p(t)*. A key gives *p* (positions) and *R* (rotations: axis times angle). Between two "
      "keys *p* is interpolated along a line and *R* by slerp, turning through the angle closest "
      "to the difference of the two rotation vectors, so keys about one axis may lie more than "
      "half a turn apart. In a step it may turn by less than that. Where a host says where it is "
      "at the end of a step, it goes there along a screw.\n\n"
      "The header of the CSV file names columns and units in any order: `t [s], x [mm], y [mm], "
      "z [mm], rx [deg], ry [deg], rz [deg]`; `t` is required, what is left out is zero.");
  d.attribute("times", &Track::times_, "s", between(-1e6, 1e6), "Times of the keys, increasing.");
  d.attribute("positions", &Track::positions_, "m", between(-1e6, 1e6),
              "Translation at each key, x y z one after the other; left out: none.");
  d.attribute("rotations", &Track::rotations_, "rad", between(-1e4, 1e4),
              "Rotation vector at each key, x y z one after the other; left out: none.");
  d.attribute("turns", &Track::turns_, "rad", any(),
              "Angle at each key by which the needle of 'about' has advanced along its own arc.");
  d.attribute("file", &Track::file_, "CSV file with the keys, instead of times.");
  d.attribute("centre", &Track::centre_, "m", between(-1e6, 1e6),
              "Rotations turn about this point: the centre of the needle's arc, say.");
  d.link("about", &Track::about_,
         "A thread with a curved needle: rotations and turns go about the centre of its arc, as it "
         "stands at the start, and turns about its axis. Positions then move that centre.")
      .named_only();
  d.attribute("easing", &Track::easing_, {"linear", "smooth"},
              "Pace between two keys: constant speed, or at rest at every key (3u^2 - 2u^3).");
  d.input("position", "m", any(),
          "Where the centre is at the end of the next step. From then on the keys count no more.",
          [](Track& t, const Vec3& centre) {
            Pose pose = t.told_ ? t.target_ : t.now_;
            pose.position = centre - pose.rotation * t.pivot_;
            t.move_to(pose);
          });
  d.input("rotation", "rad", any(),
          "Rotation vector at the end of the next step, about the centre, which stays where it is "
          "or was told to go. From then on the keys count no more.",
          [](Track& t, const Vec3& vector) {
            Pose pose = t.told_ ? t.target_ : t.now_;
            const Vec3 centre = pose.position + pose.rotation * t.pivot_;
            pose.rotation = rotation_from_vector(vector);
            pose.position = centre - pose.rotation * t.pivot_;
            t.move_to(pose);
          });
  d.output("position", "m", "Translation p of the motion plus the centre.",
           [](const Track& t) -> Vec3 { return t.now_.position + t.now_.rotation * t.pivot_; });
}

void Track::initialise(Setup& setup) {
  dt_ = setup.dt;
  std::vector<KeyFrame> keys;
  pivot_ = centre_;
  if (about_ && !find_axis(setup)) return;
  if (!about_ && !turns_.empty()) {
    setup.error(*this, "'turns' needs 'about', the thread whose needle turns");
    return;
  }
  if (file_.path.empty()) {
    keys = keys_from_attributes(setup);
  } else if (!times_.empty() || !positions_.empty() || !rotations_.empty() || !turns_.empty()) {
    setup.error(*this, "keys are given twice, by 'file' and by 'times'; expected one of them");
  } else {
    keys = keys_from_file(setup);
  }
  if (keys.empty()) return;  // reported above
  if (const std::string wrong = KeyFrames::check(keys); !wrong.empty()) {
    setup.error(*this, wrong);
    return;
  }
  std::vector<Real> times;
  for (const KeyFrame& key : keys) times.push_back(key.time);
  setup.warn_of_hidden_keys(*this, times);
  frames_ = KeyFrames(std::move(keys), pivot_, easing_);
  if (const Real turn = frames_.largest_turn(dt_); !(turn < std::numbers::pi)) {
    setup.error(*this, "turns by up to " + format_real(std::round(100 * turn) / 100) +
                           " rad in a step of " + format_real(dt_) +
                           " s; expected less than half a turn: what follows it would go the "
                           "shorter way round");
    return;
  }
  before_ = now_ = half_way_ = frames_.at(0);
}

void Track::archive(Archive& a) {
  a("before", before_);
  a("now", now_);
  a("told", told_);
  a("target", target_);
  step_ = -1;
}

void Track::move_to(const Pose& pose) {
  told_ = true;
  target_ = pose;
}

/// Called once for a step, or for parts of it, and once more for each part that is done again.
void Track::drive(const StepContext& context) {
  if (!told_) {
    before_ = frames_.at(context.time);
    now_ = frames_.at(context.end());
    half_way_ = frames_.at(context.time + context.dt / 2);
    return;
  }
  if (context.step != step_) {
    step_ = context.step;
    step_begin_ = context.time;
    from_ = now_;
  }
  before_ = on_the_way(context.time);
  now_ = on_the_way(context.end());
  half_way_ = on_the_way(context.time + context.dt / 2);
}

/// To where a host has told it to go, at this time of the step.
Pose Track::on_the_way(Real time) const {
  const Real part = (time - step_begin_) / dt_;
  constexpr Real rounding = 1e-9;
  if (part < rounding) return from_;
  if (part > 1 - rounding) return target_;
  return on_screw(from_, target_, part);
}

std::vector<KeyFrame> Track::keys_from_attributes(Setup& setup) {
  const std::size_t n = times_.size();
  if (n == 0) {
    setup.error(*this,
                "no key frames; expected 'times' (with 'positions' or 'rotations') or 'file'");
    return {};
  }
  bool fits = true;
  if (!turns_.empty() && !rotations_.empty()) {
    setup.error(*this, "keys turn twice, by 'rotations' and by 'turns'; expected one of them");
    return {};
  }
  if (!turns_.empty() && turns_.size() != n) {
    fits = false;
    setup.error(*this, "'turns' has " + std::to_string(turns_.size()) +
                           " numbers; expected one for each of the " + std::to_string(n) +
                           " times");
  }
  const auto check = [&](const std::vector<Real>& list, const char* name) {
    if (list.empty() || list.size() == 3 * n) return;
    fits = false;
    setup.error(*this, "'" + std::string(name) + "' has " + std::to_string(list.size()) +
                           " numbers; expected three for each of the " + std::to_string(n) +
                           " times, " + std::to_string(3 * n));
  };
  check(positions_, "positions");
  check(rotations_, "rotations");
  if (!fits) return {};
  const auto triple = [](const std::vector<Real>& list, std::size_t i) {
    return list.empty() ? Vec3(Vec3::Zero()) : Vec3(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
  };
  std::vector<KeyFrame> keys(n);
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = {times_[i], triple(positions_, i),
               turns_.empty() ? triple(rotations_, i) : Vec3(turns_[i] * axis_)};
  }
  return keys;
}

std::vector<KeyFrame> Track::keys_from_file(Setup& setup) {
  const std::filesystem::path file = setup.resolve(file_.path);
  std::vector<FileProblem> problems;
  std::vector<KeyFrame> keys = read_key_frames(file, problems);
  for (const FileProblem& p : problems) {
    // A problem of a line is shown there; one of the whole file, where the scene names it.
    if (p.line > 0) {
      setup.diagnostics.error({file.string(), p.line}, path(), p.message, Category::file);
    } else {
      const bool is_there = std::filesystem::exists(file);
      setup.error(
          *this,
          file.string() + ": " + p.message + (is_there ? "" : setup.did_you_mean_file(file_.path)),
          Category::file);
    }
  }
  if (problems.empty()) setup.note_if_outside(*this, file_.path);
  return keys;
}

/// Centre and axis of the needle's arc: the circle that leaves the tip along its tangent and passes
/// through the needle's end.
bool Track::find_axis(Setup& setup) {
  if (says("centre")) {
    setup.error(*this, "'centre' and 'about' both say what to turn about; expected one of them");
    return false;
  }
  const Vec3 tip = about_->point(0, Configuration::current);
  const Vec3 chord = about_->point(about_->needle_length(), Configuration::current) - tip;
  const Vec3 tangent = about_->tangent(0, Configuration::current);
  const Vec3 across = chord - chord.dot(tangent) * tangent;
  if (!(across.norm() > 1e-6 * chord.norm())) {
    setup.error(*this, about_->needle_length() > 0
                           ? "the needle of 'about' is straight: it has no centre to turn about"
                           : "the thread of 'about' has no needle");
    return false;
  }
  const Vec3 inward = across.normalized();
  pivot_ = tip + chord.squaredNorm() / (2 * chord.dot(inward)) * inward;
  // The tip advances against the tangent, which leads from it to the thread.
  axis_ = inward.cross(tangent);
  return true;
}

}  // namespace sutura::tools
