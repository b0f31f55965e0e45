// Looks at the file of a plugin before the system maps it.
#pragma once

#include <filesystem>
#include <string>

namespace sutura {

/// What keeps the file from being loaded, in a sentence, or empty. A library that is cut short
/// passes the loader and ends the program with a bus error at the first page that is missing.
std::string check_plugin_file(const std::filesystem::path& file);

}  // namespace sutura
