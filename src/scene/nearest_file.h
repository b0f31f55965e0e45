// Which file was probably meant by one that does not exist.
#pragma once

#include <filesystem>
#include <string>

namespace sutura {

/// Written as `file` is, relative to `directory`; empty if nothing is close. Looks at files of the
/// folder that is named, of those that are spelt like it, of the folders in and beside it.
std::string nearest_file(const std::filesystem::path& directory, const std::string& file);

}  // namespace sutura
