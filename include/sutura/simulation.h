// A compiled scene: flat lists of bodies, sources and recorders, and the step over them.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sutura/body.h"
#include "sutura/constraints.h"
#include "sutura/scene.h"

namespace sutura {

/// The stages of a step, in order (docs/step.md). linearise to measure are one pass.
enum class Stage {
  inputs,
  linearise,
  compliance,
  solve,
  correct,
  detect,
  build,
  measure,
  commit,
  record
};
inline constexpr std::array<std::string_view, 10> stage_names{
    "inputs", "linearise", "compliance", "solve",  "correct",
    "detect", "build",     "measure",    "commit", "record"};

/// Work on one body since the first step (J): of each force at the end of a step times the motion
/// of that step, as implicit Euler has it.
struct Work {
  Real loads = 0;
  Real holds = 0;  ///< of holds, and of supports that move
  Real constraints = 0;
};

struct BodyReport {
  std::string body;     ///< path
  Imbalance imbalance;  ///< at the end of the step; the worst of its parts, if it was divided
  Real time_error = 0;  ///< of the step, the sum over its parts (m; Body::time_error)
  Work work;
};

struct StepReport {
  Index step = 0;
  Real time = 0;  ///< s, at the end of the step
  Index blocks = 0;
  Index rows = 0;
  SolveReport solve;  ///< of the last pass; events are those of the whole step
  Index passes = 0;   ///< of all parts of the step, failed tries included
  /// Into how many the step was divided: the sum, over what lies between two events, of the most
  /// parts that were tried.
  Index parts = 1;
  Index order = 1;     ///< in time: 2 if the scene asks for it and no part had rows
  bool solved = true;  ///< every part met the tolerances
  /// Of the steps so far, this one included: not solved, or with faults. Part of the state, so a
  /// run that goes on from a state knows what the run before it missed.
  Index missed_steps = 0;
  bool missed() const { return !solved || !faults.empty(); }  ///< this step
  Real violation = 0;  ///< of the end state, largest distance of a block from its law (m)
  std::vector<BodyReport> bodies;  ///< in the order of Simulation::bodies
  bool finite = true;
  std::vector<std::string> messages;  ///< what is worth knowing of the bodies: "path: sentence"
  std::vector<std::string> faults;    ///< why this step cannot be trusted: "path: sentence"
  /// A component threw, or the scene asks for more rows than fit: the step is unfinished, and no
  /// further one is taken. Also of recorders when a recording begins or ends, and when a state is
  /// saved or restored.
  std::optional<Diagnostic> failure;
  std::array<double, stage_names.size()> seconds{};  ///< wall time per stage
  double total_seconds() const;
  Imbalance worst_imbalance() const;  ///< relative, over the bodies
  Real worst_time_error() const;      ///< m, over the bodies
};

/// Moves something by the clock, or as a host has told it: tracks, graspers. Stage inputs. One that
/// links to another is asked after it.
class Driver {
 public:
  static constexpr const char* interface_name = "Driver";
  virtual ~Driver() = default;
  /// Once per step, or per part of a step that was divided; and once before the first one, with a
  /// step of no length, where a body settles.
  virtual void drive(const StepContext& context) = 0;
  /// First time after `time` at which it does something at once, as jaws open or blades close (s);
  /// infinity if there is none. A step that such a time lies in is divided there, or up to an
  /// eighth of a step earlier: `drive` then does what is due by `context.time + context.early`.
  virtual Real next_event(Real /*time*/) const { return std::numeric_limits<Real>::infinity(); }
};

class Simulation;
class OutputFolder;
struct Chunk;
class LawCheck;
class IdleBlocks;
class BestGuess;
class BetterGuess;
template <class, std::size_t>
class StageTimer;

/// Reads the state after each step and writes files. Never changes anything.
class Recorder {
 public:
  static constexpr const char* interface_name = "Recorder";
  virtual ~Recorder() = default;
  /// Once, before the first step and when bodies have settled, whether anything will be recorded or
  /// not: for what is counted from there and read as an output.
  virtual void begin(const Simulation& /*simulation*/) {}
  /// After compile, before the first step. Returns an error sentence, or empty.
  virtual std::string start(const Simulation& simulation) = 0;
  virtual std::string record(const Simulation& simulation, const StepReport& report) = 0;
  virtual std::string finish(const Simulation& simulation) = 0;
  /// Instead of start, after the state has been restored: cuts the files back to what they were at
  /// that step and goes on. One that keeps no state begins its files anew.
  virtual std::string resume(const Simulation& simulation) { return start(simulation); }
};

class Simulation {
 public:
  /// Initialises the components in the order of their links. Nothing if there is any error.
  /// `allow_outside`: components may write files outside of the output folder.
  static std::unique_ptr<Simulation> compile(std::unique_ptr<Scene> scene,
                                             const std::filesystem::path& output_directory,
                                             Diagnostics& diagnostics, bool allow_outside = false,
                                             const Resources& resources = {});
  ~Simulation();

  /// One time step. Never throws; what went wrong is in the report. After a `failure` it does
  /// nothing any more.
  const StepReport& step();
  /// Takes the output folder (one run owns it; what the run before wrote there is removed), opens
  /// the files of recorders and records the initial state; closes them. Error sentence or empty.
  std::string start_recording();
  std::string finish_recording();
  /// Instead of start_recording, after `restore`: the files are cut back to that step and go on.
  std::string resume_recording();

  /// Everything that the next steps depend on: a simulation of the same scene that restores it
  /// takes the same steps, to the bit (docs/concepts/state.md). Between steps only. Empty after a
  /// `failure`, also one of a component that throws while it is saved.
  std::vector<std::byte> save();
  /// What keeps the state from being restored (damage, another scene, another build), in a
  /// sentence, or empty. Then nothing is changed; if a component throws, a `failure`.
  std::string restore(std::span<const std::byte> state);
  /// The same to and from a file. Killed while it writes, it leaves the file that was there before.
  std::string save(const std::filesystem::path& file);
  std::string restore(const std::filesystem::path& file);

  /// The first thing that went wrong with a recorder; nothing is recorded after it.
  const std::string& record_error() const { return record_error_; }

  const Scene& scene() const { return *scene_; }
  const StepReport& report() const { return report_; }
  const ConstraintProblem& problem() const { return problem_; }
  Real time() const { return report_.time; }
  /// A component by path ("/skin/tissue"), or nullptr.
  Component* find(std::string_view path) const { return scene_->find(path); }

  struct NamedBody {
    std::string path;
    Body* body = nullptr;
  };
  const std::vector<NamedBody>& bodies() const { return bodies_; }

 private:
  Simulation();
  void archive_run(Archive& archive);
  template <class Call>
  std::string with_state(const char* when, const Call& call);
  std::vector<std::byte> state_now();
  std::string check_state(std::span<const std::byte> state, std::vector<Chunk>& chunks) const;
  std::string read_state(const std::vector<Chunk>& chunks);
  bool settle(Diagnostics& diagnostics);
  using Timer = StageTimer<Stage, stage_names.size()>;
  /// Notes who is at work, so that one that throws can be named.
  template <class T>
  T& ask(T* who) {
    asked_ = dynamic_cast<const Component*>(who);
    return *who;
  }
  template <class Call>
  std::string ask_recorder(Recorder& recorder, const Call& call);
  std::string take_folder(bool files_stay);
  void take_step(Timer& timer);
  Real due_at(Real begin, Real end) const;
  Real next_event(Real due, Real end);
  void take_stretch(Real begin, Real length, Real due, Timer& timer);
  void begin_report();
  void record();
  bool balance(StepContext context, Index most, Timer& timer);
  bool needs_first_order(const StepContext& context) const;
  bool balance_in_first_order(StepContext context, Index most, Timer& timer);
  void pass(const StepContext& context, Timer& timer);
  void detect(const StepContext& context);
  void keep_guess();
  void build(const StepContext& context, Timer& timer);
  void build(const StepContext& context, Timer& timer, ConstraintBuilder::Warm warm);
  void check_gaps();
  void lead_gaps(const StepContext& context);
  void solve(ConstraintProblem& problem);
  bool measure(const StepContext& context);
  bool is_short_enough(const StepContext& context);
  bool knows_ways();
  bool is_revised(const StepContext& context);
  bool leave_saddles();
  bool goes_on_as_before(const StepContext& context);
  Index least_passes() const;
  void forget_passes();
  void end_with_best_guess(const StepContext& context, Timer& timer);
  void constraint_force(std::size_t body, const GrowingVec& lambda);
  void note_fault(const std::string& path, const std::string& fault);
  void accept(const StepContext& context, bool solved, Timer& timer);
  std::unique_ptr<Scene> scene_;
  std::vector<NamedBody> bodies_;
  std::vector<Driver*> drivers_;
  std::vector<ConstraintSource*> sources_;
  std::vector<std::string> source_paths_;
  std::vector<Recorder*> recorders_;
  std::unique_ptr<Component> default_solver_;
  ConstraintSolver* solver_ = nullptr;
  ConstraintProblem problem_;
  std::unique_ptr<ConstraintBuilder> builder_;
  std::filesystem::path output_directory_;
  std::vector<std::string> written_files_;  ///< relative to the folder, with patterns
  std::unique_ptr<OutputFolder> output_;    ///< from start_recording to finish_recording
  std::unique_ptr<LawCheck> law_check_;
  std::unique_ptr<IdleBlocks> idle_;
  std::vector<const Body*> const_bodies_;
  std::vector<VecX> body_force_;      ///< of the constraints, per body (N, N m)
  std::vector<Imbalance> imbalance_;  ///< of the present guess, per body
  std::vector<char> settled_;         ///< per body: the next pass leaves it where it is
  Real violation_ = 0;                ///< likewise
  bool may_divide_ = false;           ///< this part of the step may be shorter
  Real relative_violation_ = 0;       ///< that of the present guess, beside what is allowed
  std::unique_ptr<BetterGuess> better_guess_;
  std::unique_ptr<BestGuess> best_guess_;
  std::vector<VecX> motion_;          ///< memory of `detect`
  std::vector<VecX> free_motion_;     ///< to the last guess of the step that the way to is free
  std::string identity_;              ///< of scene, files and build: what a state must agree with
  GrowingVec lambda_change_;          ///< of the pass (N)
  const Component* asked_ = nullptr;  ///< the component at work
  StepReport report_;
  bool recording_ = false;
  std::string record_error_;  ///< the first one; recording stops there
};

}  // namespace sutura
