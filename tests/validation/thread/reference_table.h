// Reads the numeric tables of tests/reference.
#pragma once

#include <gtest/gtest.h>

#include <charconv>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace sutura::thread {

/// Rows of a CSV file by column name; text columns are kept as text.
struct ReferenceTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  explicit ReferenceTable(const std::string& file) {
    std::ifstream in(std::string(SUTURA_SOURCE_DIR) + "/tests/reference/" + file);
    EXPECT_TRUE(in.good()) << file;
    std::string line;
    while (std::getline(in, line)) {
      if (line.empty() || line[0] == '#') continue;
      std::vector<std::string> cells;
      std::string cell;
      bool quoted = false;
      for (const char c : line + ",") {
        if (c == '"')
          quoted = !quoted;
        else if (c == ',' && !quoted)
          cells.push_back(std::exchange(cell, {}));
        else if (c != '\r')
          cell += c;
      }
      if (names.empty())
        names = cells;
      else
        rows.push_back(cells);
    }
  }
  std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return i;
    ADD_FAILURE() << "no column " << name;
    return 0;
  }
  const std::string& text(std::size_t row, const std::string& name) const {
    return rows.at(row).at(column(name));
  }
  double number(std::size_t row, const std::string& name) const {
    const std::string& t = text(row, name);
    double value = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(t.data(), t.data() + t.size(), value);
    return value;
  }
};

}  // namespace sutura::thread
