#include "base/nearest_name.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "sutura/diagnostics.h"

namespace sutura {

namespace {

constexpr std::size_t longest_name = 100;  // keeps hostile input from costing time

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

/// At most a third of the letters may be wrong; in two or three letters, one.
std::string by_spelling(std::string_view name, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t letters = std::max(name.size(), candidate.size());
    const std::size_t difference = letters - std::min(name.size(), candidate.size());
    const std::size_t allowed = letters < 2 ? 0 : std::max<std::size_t>(letters / 3, 1);
    if (letters > longest_name || difference > allowed) continue;
    const std::size_t distance = edit_distance(name, candidate);
    if (distance > allowed) continue;
    // As near as the best, the longer one shares more letters: 'kP' is rather kPa than km.
    if (best.empty() || distance < best_distance ||
        (distance == best_distance && candidate.size() > best.size())) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

/// One name is part of the other: "tissue_young" for young, "direction" for tip_direction. The one
/// that has the most letters in common.
std::string by_part(std::string_view name, std::span<const std::string> candidates) {
  constexpr std::size_t shortest_part = 4;
  const std::string wanted = bare(name);
  std::string best;
  double best_share = 0;
  for (const std::string& candidate : candidates) {
    const std::string other = bare(candidate);
    const auto& [part, whole] =
        wanted.size() < other.size() ? std::tie(wanted, other) : std::tie(other, wanted);
    if (part.size() < shortest_part || whole.find(part) == std::string::npos) continue;
    const double share = static_cast<double>(part.size()) / static_cast<double>(whole.size());
    if (share <= best_share) continue;
    best_share = share;
    best = candidate;
  }
  return best;
}

}  // namespace

std::string bare(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != '_' && c != '-' && c != ' ') out += lower(c);
  return out;
}

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  if (name.empty() || name.size() > longest_name) return {};
  const std::string wanted = bare(name);
  for (const std::string& candidate : candidates)
    if (bare(candidate) == wanted) return candidate;
  if (std::string other = other_word(name, candidates); !other.empty()) return other;
  if (std::string near = by_spelling(name, candidates); !near.empty()) return near;
  return by_part(name, candidates);
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
  const std::string near = nearest_name(name, candidates);
  return near.empty() ? std::string() : "; did you mean '" + near + "'?";
}

}  // namespace sutura
