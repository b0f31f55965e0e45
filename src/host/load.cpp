// From a scene to a session.
#include <cmath>

#include "host/call.h"
#include "host/host_pool.h"

namespace sutura::host {
namespace {

thread_local std::vector<Diagnostic> found;

/// What is wrong with the options, or empty.
std::string check(const sutura_options& options) {
  if (options.struct_size < first_size<sutura_options>)
    return "struct_size of the options is " + std::to_string(options.struct_size) + "; expected " +
           std::to_string(sizeof(sutura_options));
  if (options.api != SUTURA_API)
    return "the program was compiled for version " + std::to_string(options.api) +
           " of the interface; this library has version " + std::to_string(SUTURA_API);
  const auto has_null = [](const char* const* texts, std::size_t count) {
    if (count > 0 && texts == nullptr) return true;
    for (std::size_t i = 0; i < count; ++i)
      if (texts[i] == nullptr) return true;
    return false;
  };
  if (has_null(options.plugin_directories, options.plugin_directory_count))
    return "a plugin directory is null";
  if (has_null(options.settings, 2 * options.setting_count)) return "a setting is null";
  return {};
}

LoadOptions load_options(const sutura_options& options) {
  LoadOptions out;
  for (std::size_t i = 0; i < options.plugin_directory_count; ++i)
    out.plugin_directories.emplace_back(options.plugin_directories[i]);
  for (std::size_t i = 0; i < options.setting_count; ++i)
    out.overrides.emplace_back(options.settings[2 * i], options.settings[2 * i + 1]);
  return out;
}

/// Everything that has a handle.
void list_parts(Session& session) {
  session.components = session.simulation->scene().components();
  for (Component* c : session.components) {
    for (const InputInfo& info : c->info().inputs) session.inputs.push_back({c, &info});
    for (const OutputInfo& info : c->info().outputs) {
      const OutputHandle output{c, &info};
      const OutputValue value = output.read();
      session.outputs.push_back({output, std::holds_alternative<Real>(value)   ? 1U
                                         : std::holds_alternative<Vec3>(value) ? 3U
                                                                               : 0U});
    }
    if (auto* tool = dynamic_cast<Tool*>(c)) session.tools.push_back({c->path(), tool});
  }
  for (const Simulation::NamedBody& b : session.simulation->bodies())
    session.shapes.push_back({b.path, b.body, {}, 0, 0});
}

/// The first error, and how many more there are.
sutura_status refuse(const Diagnostics& diagnostics) {
  std::string sentence;
  for (const Diagnostic& d : diagnostics.all())
    if (d.severity == Severity::error) {
      sentence = d.text();
      break;
    }
  if (diagnostics.errors() > 1)
    sentence += " (and " + std::to_string(diagnostics.errors() - 1) + " more)";
  return fail(diagnostics.exit_code(), sentence);
}

/// `read` makes a scene: from a file or from text. `name` is that of the output folder.
template <class Read>
sutura_status load(const std::filesystem::path& name, const sutura_options* options,
                   sutura_simulation* simulation, const Read& read) noexcept {
  return guarded([&](const std::fenv_t& environment) -> sutura_status {
    found.clear();
    if (simulation == nullptr) return fail(SUTURA_MISUSE, "a pointer is null");
    *simulation = 0;
    sutura_options as_given{};
    if (options != nullptr) {
      if (const std::string wrong = check(*options); !wrong.empty())
        return fail(SUTURA_MISUSE, wrong);
      std::memcpy(&as_given, options, std::min<std::size_t>(options->struct_size, sizeof as_given));
    }
    auto session = std::make_shared<Session>();
    session->message = as_given.message;
    session->user = as_given.user;
    session->environment = &environment;
    enrol_builtin(session->registry);
    Resources resources{nullptr, common_cache()};
    if (as_given.enqueue != nullptr)
      resources.pool = std::make_shared<HostPool>(*session, as_given.enqueue, as_given.pool);
    Diagnostics diagnostics;
    std::unique_ptr<Scene> scene = read(session->registry, diagnostics, load_options(as_given));
    if (scene)
      session->simulation = Simulation::compile(
          std::move(scene),
          as_given.output != nullptr ? std::filesystem::path(as_given.output) : "out" / name.stem(),
          diagnostics, as_given.allow_outside != 0, resources);
    for (const Diagnostic& d : diagnostics.all())  // the host may load another scene meanwhile
      session->tell(d.severity == Severity::error ? SUTURA_ERROR : SUTURA_WARNING, d.text());
    found.assign(diagnostics.all().begin(), diagnostics.all().end());
    if (!session->simulation) return refuse(diagnostics);
    list_parts(*session);
    session->initial = session->simulation->save();
    *simulation = handle(keep(std::move(session)), Kind::simulation);
    return ok;
  });
}

}  // namespace
}  // namespace sutura::host

using namespace sutura;
using namespace sutura::host;

sutura_status sutura_load(const char* file, const sutura_options* options,
                          sutura_simulation* simulation) {
  if (file == nullptr) return fail(SUTURA_MISUSE, "a pointer is null");
  return load(file, options, simulation,
              [file](Registry& registry, Diagnostics& diagnostics, const LoadOptions& how) {
                return load_scene(file, registry, diagnostics, how);
              });
}

sutura_status sutura_load_text(const char* text, size_t size, const char* name,
                               const char* directory, const sutura_options* options,
                               sutura_simulation* simulation) {
  if (text == nullptr) return fail(SUTURA_MISUSE, "a pointer is null");
  const char* const called = name == nullptr ? "scene" : name;
  return load(called, options, simulation,
              [=](Registry& registry, Diagnostics& diagnostics, const LoadOptions& how) {
                return load_scene_text({text, size}, called, directory == nullptr ? "" : directory,
                                       registry, diagnostics, how);
              });
}

sutura_status sutura_destroy(sutura_simulation simulation) {
  std::shared_ptr<Session> session;  // ends after the call, when nothing is held any more
  return with(simulation, Kind::simulation, &session, [&](Session& s, std::size_t) {
    if (s.recording) s.simulation->finish_recording();
    session = drop(session_of(simulation));
    return ok;
  });
}

size_t sutura_diagnostic_count(void) {
  return found.size();
}

sutura_status sutura_diagnostic_at(size_t number, sutura_diagnostic* diagnostic) {
  return guarded([&](const std::fenv_t&) -> sutura_status {
    if (diagnostic == nullptr) return fail(SUTURA_MISUSE, "a pointer is null");
    if (number >= found.size())
      return fail(SUTURA_MISUSE, no_such("diagnostic", number, found.size()));
    const Diagnostic& d = found[number];
    const bool is_error = d.severity == Severity::error;
    return fill(diagnostic,
                {0, is_error ? SUTURA_ERROR : SUTURA_WARNING,
                 is_error ? static_cast<sutura_status>(d.category) : SUTURA_OK, d.location.line,
                 d.location.file.c_str(), d.node_path.c_str(), d.message.c_str()});
  });
}
