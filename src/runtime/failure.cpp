#include "runtime/failure.h"

#include <algorithm>
#include <exception>
#include <map>
#include <new>

#include "scene/output_failure.h"
#include "sutura/describe.h"
#include "sutura/device.h"
#include "sutura/scene.h"

namespace sutura {

void check_rows(const ConstraintProblem& problem, const Scene& scene) {
  if (problem.rows() <= most_rows) return;
  std::map<Index, Index> rows;  // by source, which is numbered from 1 in document order
  for (const ConstraintBlock& b : problem.blocks) rows[source_of(b.key)] += b.law->dim;
  const auto most = std::max_element(
      rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  Diagnostic d;
  d.message = std::to_string(problem.rows()) + " constraint rows in one step; expected at most " +
              std::to_string(most_rows) + " (they are a dense system)";
  const std::vector<Component*> components = scene.components();
  if (most->first >= 1 && most->first <= static_cast<Index>(components.size())) {
    const Component& c = *components[static_cast<std::size_t>(most->first - 1)];
    d.location = c.location();
    d.node_path = c.path();
    d.message += ", of which this component makes " + std::to_string(most->second);
    const auto* source = dynamic_cast<const ConstraintSource*>(&c);
    if (source != nullptr && source->rows_attribute() != nullptr)
      d.message += std::string("; '") + source->rows_attribute() + "' decides how many";
  }
  throw TooManyRows{std::move(d)};
}

Diagnostic failure_of(const Component* who, const std::string& when) {
  Diagnostic d;
  d.category = Category::internal;
  std::string name = "Sutura", whose = "Sutura", what;
  const auto blame = [&](const Component* c) {
    if (c == nullptr || c->path().empty()) return;
    d.location = c->location();
    d.node_path = c->path();
    name = c->info().name;
    if (c->info().plugin != "core") whose = "the plugin '" + c->info().plugin + "'";
  };
  blame(who);
  try {
    throw;
  } catch (const TooManyRows& rows) {
    return rows.diagnostic;
  } catch (const DeviceError& e) {
    d.category = Category::plugin;
    d.message = name + " cannot go on " + when + ": " + e.what();
    return d;
  } catch (const std::bad_alloc&) {
    d.category = Category::scene;
    d.message = name + " asks for more memory than there is, " + when;
    return d;
  } catch (const OutputFailure& e) {
    blame(e.who);
    what = std::string(": ") + e.what();
  } catch (const std::exception& e) {
    what = std::string(": ") + e.what();
  } catch (...) {
  }
  d.message = name + " failed " + when + what + " (a fault in " + whose +
              ", not in the scene: please report it)";
  return d;
}

Diagnostic failure_in_step(const Component* who, Stage stage, Index step) {
  const std::string name(stage_names[static_cast<std::size_t>(stage)]);
  return failure_of(who, "in stage '" + name + "' of step " + std::to_string(step));
}

}  // namespace sutura
