// Saving and restoring a simulation: which parts there are, and how they are found to fit.
#include "runtime/state.h"

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "base/floating_point.h"
#include "runtime/checkpoint_file.h"
#include "runtime/failure.h"
#include "sutura/archive.h"
#include "sutura/plugin.h"
#include "sutura/simulation.h"

namespace sutura {
namespace {

/// FNV-1a, 64 bits (Fowler, Noll, Vo): tells texts apart that differ by accident.
std::string hash_text(std::span<const std::byte> bytes) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const std::byte b : bytes) h = (h ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ULL;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  return text;
}

std::string build_tag() {
  return "sutura " SUTURA_VERSION " " SUTURA_BUILD_TAG;
}

void archive(Archive& a, SolveReport& r) {
  a("sweeps", r.sweeps);
  a("direct_solves", r.direct_solves);
  a("events", r.events);
  a("factorisations", r.factorisations);
  a("residual", r.residual);
  a("violation", r.violation);
  a("converged", r.converged);
}

}  // namespace

std::string identity_of(const Scene& scene) {
  std::string text = write_scene(scene);
  // How long it runs is no part of what a step does.
  const std::size_t head = text.find('>');
  if (const std::size_t at = text.find(" duration=\""); at < head) {
    const std::size_t value = at + std::string_view(" duration=\"").size();
    text.erase(at, text.find('"', value) + 1 - at);
  }
  std::string identity = "scene " + hash_text(std::as_bytes(std::span(text)));
  for (Component* c : scene.components())
    for (const AttributeInfo& a : c->info().attributes) {
      if (a.type != AttributeType::file) continue;
      const auto& file = *static_cast<const File*>(a.member(*c));
      std::vector<std::byte> bytes;
      if (file.path.empty()) continue;
      read_file(scene.file.parent_path() / file.path, bytes);
      identity += ", " + c->path() + "." + a.name + " " + hash_text(bytes);
    }
  return identity;
}

/// What belongs to no component.
void Simulation::archive_run(Archive& a) {
  a("step", report_.step);
  a("time", report_.time);
  a("blocks", report_.blocks);
  a("rows", report_.rows);
  archive(a, report_.solve);
  a("passes", report_.passes);
  a("parts", report_.parts);
  a("order", report_.order);
  a("solved", report_.solved);
  a("missed_steps", report_.missed_steps);
  a("violation", report_.violation);
  for (BodyReport& body : report_.bodies) {
    a("imbalance", body.imbalance.force);
    a("relative_imbalance", body.imbalance.relative);
    a("time_error", body.time_error);
    a("work_of_loads", body.work.loads);
    a("work_of_holds", body.work.holds);
    a("work_of_constraints", body.work.constraints);
  }
  a("finite", report_.finite);
  builder_->archive(a);
  if (default_solver_) ask(default_solver_.get()).archive(a);
}

/// A component that throws fails the simulation, as in a step; empty, or what is said of it.
template <class Call>
std::string Simulation::with_state(const char* when, const Call& call) {
  if (!report_.failure) {
    asked_ = nullptr;
    try {
      return call();
    } catch (...) {
      report_.failure = failure_of(asked_, when);
    }
  }
  return report_.failure->text();
}

std::vector<std::byte> Simulation::save() {
  std::vector<std::byte> state;
  with_state("while its state was saved", [&] {
    state = state_now();
    return std::string();
  });
  return state;
}

std::vector<std::byte> Simulation::state_now() {
  std::vector<Chunk> chunks;
  const auto add = [&chunks](const std::string& name, const auto& fill) {
    Archive a;
    fill(a);
    chunks.push_back({name, a.bytes()});
  };
  add("identity", [this](Archive& a) {
    std::string build = build_tag();
    a("scene", identity_);
    a("build", build);
  });
  add("run", [this](Archive& a) { archive_run(a); });
  for (Component* c : scene_->components())
    add(c->path(), [this, c](Archive& a) { ask(c).archive(a); });
  return pack_chunks(chunks);
}

std::string Simulation::restore(std::span<const std::byte> state) {
  // What a step has thrown is taken back with the step.
  const auto before = std::exchange(report_.failure, {});
  std::string problem = with_state("while its state was restored", [&] {
    std::vector<Chunk> chunks;
    std::string unfit = check_state(state, chunks);
    if (!unfit.empty() || before) return unfit.empty() ? read_state(chunks) : unfit;
    // A component may find only while it reads that a state is none of its own. Then all of them
    // get back what they had.
    const std::vector<std::byte> now = state_now();
    unfit = read_state(chunks);
    if (unfit.empty()) return unfit;
    std::string damage = check_state(now, chunks);
    if (damage.empty()) damage = read_state(chunks);
    if (!damage.empty()) throw std::runtime_error(unfit + "; nor could it be undone: " + damage);
    return unfit;
  });
  if (!problem.empty() && !report_.failure) report_.failure = before;
  return problem;
}

/// What of it can be told before anything is changed; its parts, of all of which the names fit.
std::string Simulation::check_state(std::span<const std::byte> state,
                                    std::vector<Chunk>& chunks) const {
  if (std::string problem = unpack_chunks(state, chunks); !problem.empty()) return problem;
  const std::vector<Component*> components = scene_->components();
  if (chunks.size() < 2 || chunks[0].name != "identity") return "not the state of a simulation";
  std::string scene, build;
  Archive identity(chunks[0].data);
  identity("scene", scene);
  identity("build", build);
  if (!identity.finished()) return "not the state of a simulation";
  if (build != build_tag())
    return "saved by another build (" + build + "), whose bits would differ; this one is " +
           build_tag();
  if (scene != identity_)
    return "saved by another scene, or a file that it reads has changed since";
  if (chunks.size() != components.size() + 2) return "not the state of this scene";
  for (std::size_t i = 1; i < chunks.size(); ++i) {
    const std::string name = i == 1 ? "run" : components[i - 2]->path();
    if (chunks[i].name != name)
      return "expected the state of " + name + ", found " + chunks[i].name;
  }
  return {};
}

std::string Simulation::read_state(const std::vector<Chunk>& chunks) {
  const FloatingPoint mode;
  const std::vector<Component*> components = scene_->components();
  const auto read = [&chunks](std::size_t i, const std::string& name, const auto& fill) {
    Archive a(chunks[i].data);
    fill(a);
    if (a.finished()) return std::string();
    return name + ": " + (a.ok() ? "more was saved than is known" : a.problem());
  };
  std::string problem = read(1, "run", [this](Archive& a) { archive_run(a); });
  for (std::size_t i = 0; i < components.size() && problem.empty(); ++i)
    problem =
        read(i + 2, components[i]->path(), [&](Archive& a) { ask(components[i]).archive(a); });
  return problem;
}

std::string Simulation::save(const std::filesystem::path& file) {
  return with_state("while its state was saved", [&] { return replace_file(file, state_now()); });
}

std::string Simulation::restore(const std::filesystem::path& file) {
  std::vector<std::byte> state;
  if (std::string problem = read_file(file, state); !problem.empty()) return problem;
  const std::string problem = restore(state);
  return problem.empty() ? problem : file.string() + ": " + problem;
}

}  // namespace sutura
