// Reads the reference tables: comment lines, a header, rows of numbers and text.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace sutura::testing {

struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  std::size_t column(const std::string& name) const {
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (header[i] == name) return i;
    }
    ADD_FAILURE() << "no column '" << name << "'";
    return 0;
  }
  std::string text(std::size_t row, const std::string& name) const {
    return rows.at(row).at(column(name));
  }
  double number(std::size_t row, const std::string& name) const {
    return std::stod(text(row, name));
  }
};

inline std::vector<std::string> split_csv_line(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else if (c != '\r')
      cells.back() += c;
  }
  return cells;
}

inline Table read_csv(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << "cannot open " << path;
  Table table;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (table.header.empty())
      table.header = split_csv_line(line);
    else
      table.rows.push_back(split_csv_line(line));
  }
  return table;
}

/// Of tests/reference.
inline Table reference(const std::string& name) {
  return read_csv(std::string(SUTURA_SOURCE_DIR) + "/tests/reference/" + name);
}

}  // namespace sutura::testing
