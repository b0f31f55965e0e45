// What went wrong, where, and what was probably meant. Loading collects; nothing throws, nothing
// prints.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sutura {

struct SourceLocation {
  std::string file;
  int line = 0;  ///< 1-based; 0 when the problem has no line (a missing file, say)
};

enum class Severity { warning, error };

/// Decides the exit code of the command (docs/command.md). Internal: a component broke its
/// promises.
enum class Category { scene = 2, file = 3, plugin = 6, internal = 70 };

struct Diagnostic {
  Severity severity = Severity::error;
  Category category = Category::scene;
  SourceLocation location;
  std::string node_path;  ///< "/skin/tissue", or empty
  std::string message;    ///< one sentence: what was found, what was expected

  std::string text() const;  ///< "file:line: error: [node_path] message"
};

class Diagnostics {
 public:
  void add(Diagnostic diagnostic);
  void error(SourceLocation where, std::string node_path, std::string message,
             Category category = Category::scene);
  void warning(SourceLocation where, std::string node_path, std::string message,
               Category category = Category::scene);

  bool ok() const { return errors_ == 0; }
  std::size_t errors() const { return errors_; }
  std::span<const Diagnostic> all() const { return all_; }
  /// 0, or the category of the first error.
  int exit_code() const;

 private:
  std::vector<Diagnostic> all_;
  std::size_t errors_ = 0;
};

/// The candidate that was probably meant by `name`, or empty: the same name spelt another way, the
/// word of another program for it, the nearest by spelling (at most a third of the letters wrong),
/// or one that is part of the other.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);
/// "; did you mean 'tissue'?", to end a message with, or nothing.
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

}  // namespace sutura
