// Of the slips of the keyboard in names that a scene may contain, nearly all get the right name
// suggested.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sutura/plugin.h"

namespace sutura::house {
namespace {

using Names = std::vector<std::string>;

/// One slip: a letter left out, doubled, wrong, one too many, two swapped, or the shift key.
std::string slip(std::string name, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto letter = [&] { return static_cast<char>('a' + below(26)); };
  const std::size_t at = below(name.size());
  switch (below(6)) {
    case 0:
      return name.erase(at, 1);
    case 1:
      return name.insert(at, 1, name[at]);
    case 2:
      name[at] = letter();
      return name;
    case 3:
      return name.insert(at, 1, letter());
    case 4:
      if (at + 1 < name.size()) std::swap(name[at], name[at + 1]);
      return name;
    default:
      name[at] = static_cast<char>(name[at] ^ 0x20);
      return name;
  }
}

struct Score {
  int right = 0;
  int all = 0;
  std::string missed;

  void take(const Names& names, std::mt19937& random) {
    for (const std::string& name : names) {
      for (int i = 0; i < 20; ++i) {
        const std::string typed = slip(name, random);
        if (std::find(names.begin(), names.end(), typed) != names.end()) continue;
        ++all;
        const std::string found = nearest_name(typed, names);
        if (found == name)
          ++right;
        else
          missed += typed + " for " + name + (found.empty() ? "" : " got " + found) + "\n";
      }
    }
  }
};

TEST(Typos, GetTheRightName) {
  Registry registry;
  enrol_builtin(registry);
  Diagnostics d;
  const Names folders{SUTURA_BINARY_DIR "/lib/sutura"};
  for (const std::string& plugin : available_plugins(folders))
    ASSERT_TRUE(load_plugin(registry, plugin, folders, {}, d));
  std::mt19937 random(20261121);
  Score score;
  Names tags{"node", "plugin"};
  for (const ComponentInfo* info : registry.components()) {
    tags.push_back(info->name);
    Names attributes{"name"}, outputs;
    for (const AttributeInfo& a : info->attributes) {
      attributes.push_back(a.name);
      score.take(a.choices, random);
    }
    for (const LinkInfo& l : info->links) attributes.push_back(l.name);
    for (const OutputInfo& o : info->outputs) outputs.push_back(o.name);
    score.take(attributes, random);
    score.take(outputs, random);
  }
  score.take(tags, random);
  score.take({"version", "dt", "gravity", "duration"}, random);
  score.take(available_plugins(folders), random);
  ASSERT_GT(score.all, 2000);
  EXPECT_GE(score.right, 0.95 * score.all) << score.right << " of " << score.all << "\n"
                                           << score.missed;
  RecordProperty("right", score.right);
  RecordProperty("all", score.all);
}

}  // namespace
}  // namespace sutura::house
