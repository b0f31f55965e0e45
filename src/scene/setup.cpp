// What a component may ask while it is initialised: where files are, where it may write.
#include <utility>

#include "scene/nearest_file.h"
#include "sutura/component.h"
#include "sutura/units.h"

namespace sutura {

namespace {

namespace fs = std::filesystem;

/// True if `path`, with "." and ".." taken out, begins with a step up or at the root.
bool leads_out(const fs::path& path) {
  const fs::path plain = path.lexically_normal();
  return plain.is_absolute() || (!plain.empty() && *plain.begin() == "..");
}

/// Files of a folder that are somebody's, as "vtk" and "*.vtu".
struct FilesOf {
  fs::path folder;
  std::string pattern;
};
bool is_among(const FilesOf& files, const fs::path& file) {
  return !files.pattern.empty() && file.parent_path() == files.folder &&
         file.extension() == fs::path(files.pattern).extension();
}

}  // namespace

fs::path Setup::resolve(const std::string& file) const {
  return scene_directory / file;  // an absolute `file` replaces the directory
}

void Setup::note_if_outside(const Component& who, const std::string& file) {
  if (allow_outside) return;
  std::error_code ignored;
  // A scene that is named without a folder has an empty one.
  const fs::path folder = scene_directory.empty() ? fs::path(".") : scene_directory;
  const fs::path here = fs::weakly_canonical(fs::absolute(folder), ignored);
  const fs::path there = fs::weakly_canonical(fs::absolute(folder / file), ignored);
  // A folder beside the one of the scene, as ../meshes, belongs to it.
  if (!leads_out(there.lexically_relative(here.parent_path()))) return;
  warning(who,
          "'" + file +
              "' lies outside of the folders around the scene, which cannot be given away without "
              "it; --allow-outside silences this note",
          Category::file);
}

std::string Setup::did_you_mean_file(const std::string& file) const {
  const std::string near = nearest_file(scene_directory, file);
  return near.empty() ? std::string() : "; did you mean '" + near + "'?";
}

std::optional<fs::path> Setup::output(const Component& who, const std::string& attribute,
                                      const std::string& name, const std::string& pattern) {
  const fs::path plain = fs::path(name).lexically_normal();
  if (name.empty() || plain == "." || (pattern.empty() && !plain.has_filename())) {
    error(who, attribute + ": '" + name + "' names no " + (pattern.empty() ? "file" : "folder"));
    return {};
  }
  if (!allow_outside && leads_out(plain)) {
    error(who, attribute + ": '" + name +
                   "' lies outside of the output folder; expected a name inside it (or run with "
                   "--allow-outside)");
    return {};
  }
  const auto taken_by = [&](const std::string& owner) {
    error(who, attribute + ": '" + name + "' would overwrite what " + owner +
                   " writes there; expected another name");
    return std::nullopt;
  };
  const std::string place = plain.generic_string();
  if (place == ".sutura_files" || place.starts_with("checkpoint.sutura"))
    return taken_by("the program itself");
  for (const auto& [other, claim] : claims)
    if (other == place || is_among({other, claim.pattern}, plain) ||
        is_among({place, pattern}, other))
      return taken_by(claim.owner);
  claims.emplace(place, Claim{who.path(), pattern});
  return output_directory / plain;
}

void Setup::error(const Component& who, std::string message, Category category) {
  diagnostics.error(who.location(), who.path(), std::move(message), category);
}

void Setup::warning(const Component& who, std::string message, Category category) {
  diagnostics.warning(who.location(), who.path(), std::move(message), category);
}

void Setup::warn_without_effect(const Component& who, std::initializer_list<const char*> attributes,
                                const std::string& why) {
  for (const char* attribute : attributes)
    if (who.says(attribute)) warning(who, "'" + std::string(attribute) + "' has no effect: " + why);
}

void Setup::warn_of_hidden_keys(const Component& who, const std::vector<Real>& times) {
  for (std::size_t i = 2; i < times.size(); ++i)
    if (times[i] - times[i - 2] < dt)
      return warning(who, "three keys lie within one step of " + format_real(dt) + " s, at " +
                              format_real(times[i - 2]) + " to " + format_real(times[i]) +
                              " s: a step sees the end of it only, and what happens in between is "
                              "missed or lasts too long");
}

void Setup::warn_of_hidden_start(const Component& who, const std::vector<Real>& times) {
  if (times.size() > 1 && times[0] <= 0 && times[1] > 0 && times[1] <= dt)
    warning(who, "a key lies within the first step of " + format_real(dt) + " s, at " +
                     format_real(times[1]) +
                     " s: a step sees the end of it only, and what is said before is missed");
}

}  // namespace sutura
