// What a simulation has: components, inputs, outputs, bodies, tools.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/call.h"

using namespace sutura;
using namespace sutura::host;

namespace {

/// The handle of the part with this number.
sutura_status at(std::uint64_t simulation, std::size_t number, std::size_t count, Kind kind,
                 const char* what, std::uint64_t* out) {
  if (number >= count) return fail(SUTURA_MISUSE, no_such(what, number, count));
  *out = handle(session_of(simulation), kind, number);
  return ok;
}

/// The handle of the first part that `is` the one; `sentence` says that there is none.
template <class Part, class Is, class Sentence>
sutura_status search(std::uint64_t simulation, const std::vector<Part>& parts, Kind kind,
                     std::uint64_t* out, const Is& is, const Sentence& sentence) {
  const auto found = std::find_if(parts.begin(), parts.end(), is);
  if (found == parts.end()) return fail(SUTURA_MISUSE, sentence());
  *out = handle(session_of(simulation), kind, static_cast<std::size_t>(found - parts.begin()));
  return ok;
}

/// Of parts that have paths of their own: bodies and tools.
template <class Part>
sutura_status search_path(std::uint64_t simulation, const std::vector<Part>& parts, Kind kind,
                          const char* what, const char* path, std::uint64_t* out) {
  return search(
      simulation, parts, kind, out, [&](const Part& p) { return p.path == path; },
      [&] {
        std::vector<std::string> paths;
        for (const Part& p : parts) paths.push_back(p.path);
        return "there is no " + std::string(what) + " '" + path + "'" + did_you_mean(path, paths);
      });
}

bool is_called(const Component& component, const std::string& name, std::string_view whole) {
  return whole.size() == component.path().size() + 1 + name.size() &&
         whole.starts_with(component.path()) && whole[component.path().size()] == '.' &&
         whole.ends_with(name);
}

/// Geometry of the end of the last step.
void refresh(Session& session, Shape& shape) {
  if (shape.changes == session.changes) return;
  BodyGeometry fresh = shape.body->geometry();
  const BodyGeometry& old = shape.geometry;
  if (shape.topology == 0 || fresh.points.size() != old.points.size() ||
      fresh.connectivity != old.connectivity)
    ++shape.topology;
  shape.geometry = std::move(fresh);
  shape.changes = session.changes;
}

}  // namespace

sutura_status sutura_component_count(sutura_simulation simulation, size_t* count) {
  return with(simulation, Kind::simulation, count, [&](Session& session, std::size_t) {
    *count = session.components.size();
    return ok;
  });
}

sutura_status sutura_component_at(sutura_simulation simulation, size_t number,
                                  sutura_component* component) {
  return with(simulation, Kind::simulation, component, [&](Session& session, std::size_t) {
    const std::size_t count = session.components.size();
    if (number >= count) return fail(SUTURA_MISUSE, no_such("component", number, count));
    const Component& c = *session.components[number];
    return fill(component, {0, c.location().line, c.path().c_str(), c.info().name.c_str(),
                            c.info().plugin.c_str(), c.info().summary.c_str()});
  });
}

sutura_status sutura_find_input(sutura_simulation simulation, const char* name,
                                sutura_input* input) {
  const bool complete = name != nullptr && input != nullptr;
  return with(simulation, Kind::simulation, complete ? name : nullptr,
              [&](Session& session, std::size_t) {
                return search(
                    simulation, session.inputs, Kind::input, input,
                    [&](const Input& i) { return is_called(*i.component, i.info->name, name); },
                    [&] {
                      std::string error;
                      session.simulation->scene().input(name, error);
                      return error;
                    });
              });
}

sutura_status sutura_input_count(sutura_simulation simulation, size_t* count) {
  return with(simulation, Kind::simulation, count, [&](Session& session, std::size_t) {
    *count = session.inputs.size();
    return ok;
  });
}

sutura_status sutura_input_at(sutura_simulation simulation, size_t number, sutura_input* input) {
  return with(simulation, Kind::simulation, input, [&](Session& session, std::size_t) {
    return at(simulation, number, session.inputs.size(), Kind::input, "input", input);
  });
}

sutura_status sutura_describe_input(sutura_input input, sutura_value* value) {
  return with(input, Kind::input, value, [&](Session& session, std::size_t number) {
    const Input& i = session.inputs[number];
    return fill(value,
                {0, i.info->is_vector ? 3U : 1U, i.component->path().c_str(), i.info->name.c_str(),
                 i.info->unit.c_str(), i.info->doc.c_str(), i.info->range.low, i.info->range.high});
  });
}

sutura_status sutura_set_input(sutura_input input, const double* values, size_t count) {
  return with(input, Kind::input, values, [&](Session& session, std::size_t number) {
    const Input& i = session.inputs[number];
    const std::size_t size = i.info->is_vector ? 3 : 1;
    if (count != size)
      return fail(SUTURA_MISUSE, "'" + i.info->name + "' takes " +
                                     (size == 3 ? "three numbers" : "one number") + ", not " +
                                     std::to_string(count));
    const InputValue value =
        size == 3 ? InputValue(Vec3(values[0], values[1], values[2])) : InputValue(values[0]);
    const std::string problem = InputHandle(*i.component, *i.info).set(value);
    return problem.empty() ? ok : fail(SUTURA_MISUSE, i.component->path() + ": " + problem);
  });
}

sutura_status sutura_find_output(sutura_simulation simulation, const char* name,
                                 sutura_output* output) {
  const bool complete = name != nullptr && output != nullptr;
  return with(simulation, Kind::simulation, complete ? name : nullptr,
              [&](Session& session, std::size_t) {
                return search(
                    simulation, session.outputs, Kind::output, output,
                    [&](const Output& o) {
                      return is_called(*o.handle.component, o.handle.info->name, name);
                    },
                    [&] {
                      std::string error;
                      session.simulation->scene().output(name, error);
                      return error;
                    });
              });
}

sutura_status sutura_output_count(sutura_simulation simulation, size_t* count) {
  return with(simulation, Kind::simulation, count, [&](Session& session, std::size_t) {
    *count = session.outputs.size();
    return ok;
  });
}

sutura_status sutura_output_at(sutura_simulation simulation, size_t number, sutura_output* output) {
  return with(simulation, Kind::simulation, output, [&](Session& session, std::size_t) {
    return at(simulation, number, session.outputs.size(), Kind::output, "output", output);
  });
}

sutura_status sutura_describe_output(sutura_output output, sutura_value* value) {
  return with(output, Kind::output, value, [&](Session& session, std::size_t number) {
    const Output& o = session.outputs[number];
    const OutputInfo& info = *o.handle.info;
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return fill(value, {0, o.size, o.handle.component->path().c_str(), info.name.c_str(),
                        info.unit.c_str(), info.doc.c_str(), -infinite, infinite});
  });
}

sutura_status sutura_get_output(sutura_output output, double* values, size_t count) {
  return with(output, Kind::output, values, [&](Session& session, std::size_t number) {
    const Output& o = session.outputs[number];
    if (o.size == 0)
      return fail(SUTURA_MISUSE, "'" + o.handle.info->name + "' is a text, for sutura_get_text");
    if (count != o.size)
      return fail(SUTURA_MISUSE, "'" + o.handle.info->name + "' has " + std::to_string(o.size) +
                                     (o.size == 1 ? " number" : " numbers") + ", not " +
                                     std::to_string(count));
    const OutputValue value = o.handle.read();
    if (const Real* real = std::get_if<Real>(&value))
      values[0] = *real;
    else
      std::copy_n(std::get<Vec3>(value).data(), 3, values);
    return ok;
  });
}

sutura_status sutura_get_text(sutura_output output, const char** text) {
  return with(output, Kind::output, text, [&](Session& session, std::size_t number) {
    const Output& o = session.outputs[number];
    if (o.size != 0)
      return fail(SUTURA_MISUSE,
                  "'" + o.handle.info->name + "' is no text but numbers, for sutura_get_output");
    session.text = std::get<std::string>(o.handle.read());
    *text = session.text.c_str();
    return ok;
  });
}

sutura_status sutura_find_body(sutura_simulation simulation, const char* path, sutura_body* body) {
  const bool complete = path != nullptr && body != nullptr;
  return with(simulation, Kind::simulation, complete ? path : nullptr,
              [&](Session& session, std::size_t) {
                return search_path(simulation, session.shapes, Kind::body, "body", path, body);
              });
}

sutura_status sutura_body_count(sutura_simulation simulation, size_t* count) {
  return with(simulation, Kind::simulation, count, [&](Session& session, std::size_t) {
    *count = session.shapes.size();
    return ok;
  });
}

sutura_status sutura_body_at(sutura_simulation simulation, size_t number, sutura_body* body) {
  return with(simulation, Kind::simulation, body, [&](Session& session, std::size_t) {
    return at(simulation, number, session.shapes.size(), Kind::body, "body", body);
  });
}

sutura_status sutura_get_geometry(sutura_body body, sutura_geometry* geometry) {
  return with(body, Kind::body, geometry, [&](Session& session, std::size_t number) {
    Shape& shape = session.shapes[number];
    refresh(session, shape);
    const BodyGeometry& g = shape.geometry;
    static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Index) == sizeof(int64_t));
    const std::uint32_t corners = g.cell == BodyGeometry::Cell::line ? 2 : 4;
    return fill(geometry,
                {0, corners, shape.topology, shape.path.c_str(), g.points.size(),
                 g.points.empty() ? nullptr : g.points.front().data(),
                 g.connectivity.size() / corners, g.connectivity.data(), g.fields.size()});
  });
}

sutura_status sutura_get_field(sutura_body body, size_t number, sutura_field* field) {
  return with(body, Kind::body, field, [&](Session& session, std::size_t which) {
    Shape& shape = session.shapes[which];
    refresh(session, shape);
    const std::vector<BodyGeometry::Field>& fields = shape.geometry.fields;
    if (number >= fields.size())
      return fail(SUTURA_MISUSE, no_such("field", number, fields.size()));
    const BodyGeometry::Field& f = fields[number];
    const auto components = static_cast<std::size_t>(f.components);
    return fill(field, {0, f.on_cells ? 1 : 0, f.name.c_str(), f.values.size() / components,
                        components, f.values.data()});
  });
}

sutura_status sutura_find_tool(sutura_simulation simulation, const char* path, sutura_tool* tool) {
  const bool complete = path != nullptr && tool != nullptr;
  return with(simulation, Kind::simulation, complete ? path : nullptr,
              [&](Session& session, std::size_t) {
                return search_path(simulation, session.tools, Kind::tool, "tool", path, tool);
              });
}

sutura_status sutura_tool_count(sutura_simulation simulation, size_t* count) {
  return with(simulation, Kind::simulation, count, [&](Session& session, std::size_t) {
    *count = session.tools.size();
    return ok;
  });
}

sutura_status sutura_tool_at(sutura_simulation simulation, size_t number, sutura_tool* tool) {
  return with(simulation, Kind::simulation, tool, [&](Session& session, std::size_t) {
    return at(simulation, number, session.tools.size(), Kind::tool, "tool", tool);
  });
}

sutura_status sutura_get_pose(sutura_tool tool, double pose[7]) {
  return with(tool, Kind::tool, pose, [&](Session& session, std::size_t number) {
    const Pose p = session.tools[number].tool->pose();
    std::copy_n(p.position.data(), 3, pose);
    pose[3] = p.rotation.w();
    std::copy_n(p.rotation.vec().data(), 3, pose + 4);
    return ok;
  });
}

sutura_status sutura_set_pose(sutura_tool tool, const double pose[7]) {
  return with(tool, Kind::tool, pose, [&](Session& session, std::size_t number) {
    const bool finite = std::all_of(pose, pose + 7, [](double x) { return std::isfinite(x); });
    if (!finite) return fail(SUTURA_MISUSE, "the pose is not finite");
    Quat rotation(pose[3], pose[4], pose[5], pose[6]);
    constexpr Real tolerance = 1e-3;
    if (!(std::abs(rotation.norm() - 1) <= tolerance))
      return fail(SUTURA_MISUSE, "the last four numbers of the pose are no unit quaternion");
    rotation.normalize();
    session.tools[number].tool->move_to({Vec3(pose[0], pose[1], pose[2]), rotation});
    return ok;
  });
}
