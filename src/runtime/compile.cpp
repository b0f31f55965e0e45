// From the tree of a scene to the flat lists of a simulation.
#include <algorithm>
#include <set>

#include "base/floating_point.h"
#include "runtime/best_guess.h"
#include "runtime/better_guess.h"
#include "runtime/failure.h"
#include "runtime/gauss_seidel_component.h"
#include "runtime/output_folder.h"
#include "runtime/state.h"
#include "solve/idle_blocks.h"
#include "solve/law_check.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

/// Components so that each comes after those it links to; document order otherwise. Loading has
/// refused rings of links.
class InitialisationOrder {
 public:
  explicit InitialisationOrder(const Scene& scene) : scene_(scene) {
    for (Component* c : scene.components()) visit(*c);
  }
  const std::vector<Component*>& components() const { return order_; }

 private:
  void visit(Component& c) {
    if (!visited_.insert(&c).second) return;
    for (Component* target : scene_.links_of(c)) visit(*target);
    order_.push_back(&c);
  }

  const Scene& scene_;
  std::set<const Component*> visited_;
  std::vector<Component*> order_;
};

/// A component that throws broke its promise; the report names it, whatever it threw.
void call(Component& component, void (Component::*phase)(Setup&), Setup& setup) {
  try {
    (component.*phase)(setup);
  } catch (...) {
    setup.diagnostics.add(failure_of(&component, "while it was initialised"));
  }
}

/// As OutputFolder wants them; what lies outside of the folder is nobody's to remove.
std::vector<std::string> written_files(const Setup& setup) {
  std::vector<std::string> out;
  for (const auto& [name, claim] : setup.claims)
    if (!name.starts_with('/') && !name.starts_with(".."))
      out.push_back(claim.pattern.empty() ? name : name + '/' + claim.pattern);
  return out;
}

}  // namespace

Simulation::Simulation() = default;
Simulation::~Simulation() = default;

std::unique_ptr<Simulation> Simulation::compile(std::unique_ptr<Scene> scene,
                                                const std::filesystem::path& output_directory,
                                                Diagnostics& diagnostics, bool allow_outside,
                                                const Resources& resources) {
  const FloatingPoint mode;
  std::unique_ptr<Simulation> s(new Simulation);
  s->scene_ = std::move(scene);
  const std::vector<Component*> document = s->scene_->components();
  const InitialisationOrder order(*s->scene_);

  Setup setup{.diagnostics = diagnostics,
              .scene_directory = s->scene_->file.parent_path(),
              .output_directory = output_directory,
              .dt = s->scene_->dt,
              .gravity = s->scene_->gravity,
              .scene = s->scene_.get(),
              .allow_outside = allow_outside,
              .resources = resources};
  // A component whose targets failed is not initialised: what it would complain of is their fault.
  std::set<const Component*> failed;
  for (Component* c : order.components()) {
    const std::vector<Component*>& links = s->scene_->links_of(*c);
    setup.errors_before = diagnostics.errors();
    setup.source_id = std::find(document.begin(), document.end(), c) - document.begin() + 1;
    const bool stands = std::none_of(links.begin(), links.end(),
                                     [&](const Component* t) { return failed.contains(t); });
    if (stands) call(*c, &Component::initialise, setup);
    if (!stands || !setup.ok()) failed.insert(c);
  }
  if (!diagnostics.ok()) return nullptr;
  const auto ask_if_ready = [&](Component* c) {
    setup.source_id = std::find(document.begin(), document.end(), c) - document.begin() + 1;
    setup.errors_before = diagnostics.errors();
    call(*c, &Component::ready, setup);
  };
  for (Component* c : order.components()) ask_if_ready(c);
  if (!diagnostics.ok()) return nullptr;

  for (Component* c : document) {
    if (auto* body = dynamic_cast<Body*>(c)) {
      s->bodies_.push_back({c->path(), body});
      s->const_bodies_.push_back(body);
      s->report_.bodies.push_back({.body = c->path(), .imbalance = {}, .work = {}});
      s->imbalance_.emplace_back();
      s->settled_.push_back(0);
      s->body_force_.push_back(VecX::Zero(body->dofs()));
      s->motion_.push_back(VecX::Zero(body->dofs()));
      s->free_motion_.push_back(VecX::Zero(body->dofs()));
    }
    if (auto* recorder = dynamic_cast<Recorder*>(c)) s->recorders_.push_back(recorder);
    if (auto* solver = dynamic_cast<ConstraintSolver*>(c)) {
      if (s->solver_ != nullptr) {
        diagnostics.error(c->location(), c->path(),
                          "a second constraint solver; a scene has at most one");
        return nullptr;
      }
      s->solver_ = solver;
    }
  }
  if (s->solver_ == nullptr) {
    auto solver = std::make_unique<GaussSeidel>();
    s->solver_ = solver.get();
    s->default_solver_ = std::move(solver);
  }
  // A grasper is told the time after its track. Sources commit after those they link to: a puncture
  // finds the path already moved on.
  for (Component* c : order.components()) {
    if (auto* driver = dynamic_cast<Driver*>(c)) s->drivers_.push_back(driver);
    if (auto* source = dynamic_cast<ConstraintSource*>(c)) {
      s->sources_.push_back(source);
      s->source_paths_.push_back(c->path());
    }
  }
  if (!s->settle(diagnostics)) return nullptr;
  // A balance knows of no constraint: bodies may have settled into each other.
  if (std::ranges::any_of(s->bodies_, [](const NamedBody& b) { return b.body->wants_settling(); }))
    for (Component* c : order.components())
      if (dynamic_cast<ConstraintSource*>(c)) ask_if_ready(c);
  if (!diagnostics.ok()) return nullptr;
  s->builder_ = std::make_unique<ConstraintBuilder>(s->problem_, s->const_bodies_);
  s->identity_ = identity_of(*s->scene_);
  s->law_check_ = std::make_unique<LawCheck>();
  s->idle_ = std::make_unique<IdleBlocks>(s->bodies_.size());
  s->better_guess_ = std::make_unique<BetterGuess>(s->bodies_);
  s->best_guess_ = std::make_unique<BestGuess>(s->bodies_);
  s->output_directory_ = output_directory;
  s->written_files_ = written_files(setup);
  try {
    for (Recorder* recorder : s->recorders_) s->ask(recorder).begin(*s);
  } catch (...) {
    diagnostics.add(failure_of(s->asked_, "before the first step"));
    return nullptr;
  }
  return s;
}

/// Bodies that are to begin in balance: under what the drivers say of time 0.
bool Simulation::settle(Diagnostics& diagnostics) {
  for (const NamedBody& b : bodies_) b.body->load().setZero(b.body->dofs());
  const auto wants = [](const NamedBody& b) { return b.body->wants_settling(); };
  if (std::none_of(bodies_.begin(), bodies_.end(), wants)) return true;
  try {
    for (Driver* driver : drivers_) ask(driver).drive({.dt = 0, .gravity = scene_->gravity});
    for (const NamedBody& b : bodies_) {
      if (!wants(b)) continue;
      const std::string problem = ask(b.body).settle(scene_->gravity);
      if (!problem.empty())
        diagnostics.error(scene_->find(b.path)->location(), b.path, "settle: " + problem);
    }
  } catch (...) {
    diagnostics.add(failure_of(asked_, "while the scene settled"));
  }
  return diagnostics.ok();
}

}  // namespace sutura
