#include "sutura/diagnostics.h"

#include <utility>

namespace sutura {

std::string Diagnostic::text() const {
  std::string out = location.file;
  if (location.line > 0) out += ':' + std::to_string(location.line);
  if (!out.empty()) out += ": ";
  out += severity == Severity::error ? "error: " : "warning: ";
  if (!node_path.empty()) out += '[' + node_path + "] ";
  return out + message;
}

void Diagnostics::add(Diagnostic diagnostic) {
  if (diagnostic.severity == Severity::error) ++errors_;
  all_.push_back(std::move(diagnostic));
}

void Diagnostics::error(SourceLocation where, std::string node_path, std::string message,
                        Category category) {
  add({Severity::error, category, std::move(where), std::move(node_path), std::move(message)});
}

void Diagnostics::warning(SourceLocation where, std::string node_path, std::string message,
                          Category category) {
  add({Severity::warning, category, std::move(where), std::move(node_path), std::move(message)});
}

int Diagnostics::exit_code() const {
  for (const Diagnostic& d : all_)
    if (d.severity == Severity::error) return static_cast<int>(d.category);
  return 0;
}

}  // namespace sutura
