// The handshake between a plugin and its host. A plugin exports one C symbol,
// sutura_plugin_<name>, that returns this struct; every field is compared before `enrol` is called.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "sutura/diagnostics.h"
#include "sutura/registry.h"

#define SUTURA_ABI 10

// Everything that changes the layout of what crosses the boundary.
#define SUTURA_TEXT_(x) #x
#define SUTURA_TEXT(x) SUTURA_TEXT_(x)
#ifdef _GLIBCXX_RELEASE
#define SUTURA_STDLIB "libstdc++-abi" SUTURA_TEXT(_GLIBCXX_USE_CXX11_ABI)
#else
#define SUTURA_STDLIB "other"
#endif
#define SUTURA_BUILD_TAG \
  "cxxabi" SUTURA_TEXT(__GXX_ABI_VERSION) " " SUTURA_STDLIB " eigen" SUTURA_TEXT(   \
      EIGEN_WORLD_VERSION) "." SUTURA_TEXT(EIGEN_MAJOR_VERSION) "." SUTURA_TEXT(    \
      EIGEN_MINOR_VERSION) " align" SUTURA_TEXT(EIGEN_MAX_ALIGN_BYTES) " real64"

namespace sutura {

struct PluginHeader {
  std::uint32_t struct_size;  ///< sizeof(PluginHeader)
  std::uint32_t abi;          ///< SUTURA_ABI
  const char* build_tag;      ///< SUTURA_BUILD_TAG
  const char* name;
  const char* version;
  const char* licence;  ///< SPDX
  void (*enrol)(Registry&);
};

/// What is wrong with the header, in a sentence; empty if it may be called.
std::string check_plugin(const PluginHeader& header, const std::string& expected_name);

/// Looks for lib sutura_<name>.so in `directories`, checks it and enrols it. A plugin already
/// enrolled is not loaded twice. Problems go to `diagnostics` (Category::plugin) at `where`.
bool load_plugin(Registry& registry, const std::string& name,
                 const std::vector<std::string>& directories, const SourceLocation& where,
                 Diagnostics& diagnostics);

/// For plugins linked statically into the host.
bool enrol_plugin(Registry& registry, const PluginHeader& header, Diagnostics& diagnostics);

/// $SUTURA_PLUGIN_PATH (colon separated), then the folder of the installed or built plugins.
std::vector<std::string> default_plugin_directories();

/// Names of the plugins whose files lie in `directories`, sorted; none of them is opened.
std::vector<std::string> available_plugins(const std::vector<std::string>& directories);

}  // namespace sutura

/// Once per plugin, at namespace scope: SUTURA_PLUGIN(thread, "0.1.0", "Apache-2.0", enrol_thread)
#define SUTURA_PLUGIN(plugin, plugin_version, plugin_licence, enrol_function) \
  extern "C" __attribute__((visibility("default")))                           \
  const sutura::PluginHeader* sutura_plugin_##plugin() {                      \
    static const sutura::PluginHeader header{sizeof(sutura::PluginHeader),    \
                                             SUTURA_ABI,                      \
                                             SUTURA_BUILD_TAG,                \
                                             #plugin,                         \
                                             plugin_version,                  \
                                             plugin_licence,                  \
                                             enrol_function};                 \
    return &header;                                                           \
  }
