// Any bytes are a scene or are refused with a reason; what is read is written and read back alike.
#include "sutura/scene.h"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "sutura/plugin.h"

using namespace sutura;

namespace {

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

std::unique_ptr<Scene> load(std::string_view text, Diagnostics& diagnostics) {
  static const std::unique_ptr<Registry> registry = [] {
    auto r = std::make_unique<Registry>();
    enrol_builtin(*r);
    Diagnostics d;
    const std::vector<std::string> folders{SUTURA_PLUGIN_DIR};
    for (const std::string& name : available_plugins(folders))
      if (!load_plugin(*r, name, folders, {}, d)) fail(d.all().back().message.c_str());
    return r;
  }();
  return load_scene_text(text, "fuzz.xml", "/nowhere", *registry, diagnostics);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  Diagnostics diagnostics;
  const auto scene = load({reinterpret_cast<const char*>(data), size}, diagnostics);
  if ((scene == nullptr) == diagnostics.ok()) fail("refused without a reason, or in spite of one");
  for (const Diagnostic& d : diagnostics.all())
    if (d.message.empty()) fail("an empty message");
  if (!scene) return 0;
  const std::string written = write_scene(*scene);
  Diagnostics again;
  const auto read_back = load(written, again);
  if (!read_back) fail(again.all().front().message.c_str());
  if (write_scene(*read_back) != written) fail("written twice, not alike");
  return 0;
}
