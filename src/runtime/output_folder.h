// The folder of results: one run owns it, and it holds what that run wrote and nothing older.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace sutura {

/// The folder has a file `.sutura_files` that lists what a run writes there. It is locked while the
/// run lasts (also against other processes), and the next run removes what it lists.
class OutputFolder {
 public:
  OutputFolder() = default;
  ~OutputFolder() { release(); }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// What becomes of the files of the run before. They stay when this one goes on from its state.
  enum class Before { goes, stays };
  /// Makes the folder, locks it, removes what the run before wrote. `files` are relative to the
  /// folder; the last step may have one '*': "constraints/*.vtu". Error sentence or empty.
  std::string take(const std::filesystem::path& folder, const std::vector<std::string>& files,
                   Before before = Before::goes);
  void release();

 private:
  int lock_ = -1;  ///< file descriptor
};

}  // namespace sutura
