// The way in: a file or a text becomes a scene, or errors.
#include <fstream>

#include "base/floating_point.h"
#include "scene/links.h"
#include "scene/nearest_file.h"
#include "scene/reader.h"
#include "scene/xml_tree.h"
#include "sutura/scene.h"

namespace sutura {

namespace {

/// At most one byte more than allowed, so that the parser can tell that there is too much.
std::optional<std::string> read_file(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto fail = [&](std::string why) {
    diagnostics.error({file.string(), 0}, "", std::move(why), Category::file);
    return std::nullopt;
  };
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) {
    const std::string near = nearest_file(".", file.string());
    return fail("the scene does not exist" +
                (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  if (std::filesystem::is_directory(status)) return fail("this is a folder; expected a scene");
  std::ifstream stream(file, std::ios::binary);
  std::string text(XmlLimits::bytes + 1, '\0');
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream && !stream.eof()) return fail("the scene cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

}  // namespace

std::unique_ptr<Scene> load_scene_text(std::string_view text, const std::string& name,
                                       const std::filesystem::path& directory, Registry& registry,
                                       Diagnostics& diagnostics, const LoadOptions& options) {
  const FloatingPoint mode;  // reading a number rounds it
  const std::size_t errors_before = diagnostics.errors();
  auto scene = std::make_unique<Scene>();
  scene->file = directory / std::filesystem::path(name).filename();
  const std::optional<XmlElement> tree = parse_xml(text, name, diagnostics);
  if (!tree) return nullptr;
  SceneReader reader(*scene, registry, diagnostics, options, name);
  reader.read(*tree);
  resolve_links(*scene, registry, reader.links(), reader.failed(), diagnostics);
  check_rings(*scene, diagnostics);
  return diagnostics.errors() == errors_before ? std::move(scene) : nullptr;
}

std::unique_ptr<Scene> load_scene(const std::filesystem::path& file, Registry& registry,
                                  Diagnostics& diagnostics, const LoadOptions& options) {
  const std::optional<std::string> text = read_file(file, diagnostics);
  if (!text) return nullptr;
  auto scene =
      load_scene_text(*text, file.string(), file.parent_path(), registry, diagnostics, options);
  if (scene) scene->file = file;
  return scene;
}

}  // namespace sutura
