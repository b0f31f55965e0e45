#include "sutura/diagnostics.h"

#include <algorithm>
#include <utility>

namespace sutura {

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Letters to change, insert, drop or swap with their neighbour; upper and lower case count as
/// equal.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                           lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

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

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  constexpr std::size_t longest_name = 100;  // keeps hostile input from costing time
  if (name.size() > longest_name) return {};
  std::string best;
  std::size_t best_distance = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t letters = std::max(name.size(), candidate.size());
    const std::size_t difference = letters - std::min(name.size(), candidate.size());
    if (letters > longest_name || 3 * difference > letters) continue;
    const std::size_t distance = edit_distance(name, candidate);
    if (3 * distance > letters) continue;
    if (best.empty() || distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace sutura
