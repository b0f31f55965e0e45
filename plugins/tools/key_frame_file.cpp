#include "key_frame_file.h"

#include <array>
#include <fstream>
#include <optional>
#include <sstream>

#include "sutura/diagnostics.h"
#include "sutura/units.h"

namespace sutura::tools {
namespace {

constexpr std::array<std::string_view, 7> column_names{"t", "x", "y", "z", "rx", "ry", "rz"};
constexpr std::array<std::string_view, 7> column_units{"s", "m", "m", "m", "rad", "rad", "rad"};

std::string_view trim(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto comma = line.find(',');
    fields.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// Which quantity a column holds, and what its numbers are multiplied by.
struct Column {
  std::size_t quantity = 0;
  Real factor = 1;
};

class Parser {
 public:
  explicit Parser(std::vector<FileProblem>& problems) : problems_(problems) {}

  void line(int number, std::string_view text) {
    line_ = number;
    text = trim(text);
    if (text.empty() || text.front() == '#' || full()) return;
    if (columns_.empty())
      header(text);
    else
      row(text);
  }

  std::vector<KeyFrame> finish() {
    if (problems_.empty() && columns_.empty()) {
      problems_.push_back({0,
                           "the file has no header line; expected names of columns such as "
                           "'t [s], x [mm], ry [deg]'"});
    }
    if (problems_.empty() && keys_.empty()) problems_.push_back({0, "the file has no key frame"});
    if (!problems_.empty()) keys_.clear();
    return std::move(keys_);
  }

 private:
  bool full() const { return problems_.size() >= max_file_problems; }
  void problem(std::string message) {
    if (!full()) problems_.push_back({line_, std::move(message)});
  }

  void header(std::string_view text) {
    std::array<bool, 7> seen{};
    for (const std::string_view field : split(text)) {
      // A column that is wrong keeps its place, so that rows are still counted against the header.
      columns_.push_back(header_field(field).value_or(Column{}));
      const std::size_t quantity = columns_.back().quantity;
      if (!problems_.empty()) continue;
      if (seen[quantity]) problem("column '" + std::string(field) + "' comes twice");
      seen[quantity] = true;
    }
    if (problems_.empty() && !seen[0]) problem("no column 't'; expected the time of each key");
  }

  std::optional<Column> header_field(std::string_view field) {
    std::string_view name = field;
    std::string_view unit;
    if (const auto open = field.find('['); open != std::string_view::npos) {
      if (field.back() != ']') {
        problem("column '" + std::string(field) + "': expected 'name [unit]'");
        return {};
      }
      name = trim(field.substr(0, open));
      unit = trim(field.substr(open + 1, field.size() - open - 2));
    }
    std::size_t quantity = 0;
    while (quantity < column_names.size() && column_names[quantity] != name) ++quantity;
    if (quantity == column_names.size()) {
      problem("unknown column '" + std::string(name) + "'; expected t, x, y, z, rx, ry or rz");
      return {};
    }
    if (unit.empty()) return Column{quantity, 1};
    std::string error;
    const auto factor = parse_quantity("1 " + std::string(unit), column_units[quantity], error);
    if (!factor) {
      problem("column '" + std::string(field) + "': " + error);
      return {};
    }
    return Column{quantity, *factor};
  }

  void row(std::string_view text) {
    const auto fields = split(text);
    if (fields.size() != columns_.size()) {
      problem(std::to_string(fields.size()) + " fields; the header names " +
              std::to_string(columns_.size()));
      return;
    }
    std::array<Real, 7> value{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto number = parse_real(fields[i]);
      if (!number) {
        problem("'" + std::string(fields[i]) + "' in column " + std::to_string(i + 1) +
                " is not a number");
        return;
      }
      value[columns_[i].quantity] = *number * columns_[i].factor;
    }
    if (!keys_.empty() && !(value[0] > keys_.back().time)) {
      problem("time " + format_real(value[0]) + " s is not after the key before it (" +
              format_real(keys_.back().time) + " s); times must increase");
      return;
    }
    keys_.push_back({value[0], {value[1], value[2], value[3]}, {value[4], value[5], value[6]}});
  }

  std::vector<FileProblem>& problems_;
  int line_ = 0;
  std::vector<Column> columns_;
  std::vector<KeyFrame> keys_;
};

}  // namespace

std::vector<KeyFrame> parse_key_frames(std::string_view text, std::vector<FileProblem>& problems) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark of spreadsheets
  Parser parser(problems);
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    parser.line(number, text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return parser.finish();
}

std::vector<KeyFrame> read_key_frames(const std::filesystem::path& file,
                                      std::vector<FileProblem>& problems) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    problems.push_back({0, "there is no such file"});
    return {};
  }
  if (std::filesystem::file_size(file, error) > max_key_frame_bytes || error) {
    problems.push_back({0, "the file is larger than 64 MiB"});
    return {};
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in || !text) {
    // rdbuf of an empty file sets failbit on `text`: that is an empty file, not an unreadable one.
    if (in && std::filesystem::file_size(file, error) == 0) return parse_key_frames("", problems);
    problems.push_back({0, "the file cannot be read"});
    return {};
  }
  return parse_key_frames(text.str(), problems);
}

}  // namespace sutura::tools
