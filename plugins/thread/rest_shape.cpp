#include "rest_shape.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "sutura/units.h"

namespace sutura::thread {
namespace {

/// Where a helix is after s: the frame turns at the constant rate (torsion, side curvature,
/// -curvature) in its own axes while it advances along its x axis.
Pose along_helix(const RestPiece& piece, Real s) {
  const Vec3 rate(piece.torsion, piece.side_curvature, -piece.curvature);
  const Real w = rate.norm(), a = w * s;
  const Vec3 x = Vec3::UnitX();
  // (1 - cos a) / w^2 and (a - sin a) / w^3; series where they would cancel.
  const bool small = std::abs(a) < 1e-2;
  const Real second = small ? s * s * (0.5 - a * a / 24) : (1 - std::cos(a)) / (w * w);
  const Real third = small ? s * s * s * (1. / 6 - a * a / 120) : (a - std::sin(a)) / (w * w * w);
  const Vec3 position = s * x + second * rate.cross(x) + third * rate.cross(rate.cross(x));
  return {position, w > 0 ? Quat(Eigen::AngleAxis<Real>(a, rate / w)) : Quat::Identity()};
}

Pose compose(const Pose& a, const Pose& b) {
  return {a.position + a.rotation * b.position, (a.rotation * b.rotation).normalized()};
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) {
    const auto first = field.find_first_not_of(" \t\r");
    const auto last = field.find_last_not_of(" \t\r");
    fields.push_back(first == std::string::npos ? "" : field.substr(first, last - first + 1));
  }
  return fields;
}

/// "s [mm]": which column, and the unit of its numbers.
struct Column {
  int quantity = -1;  ///< 0 s, 1 curvature, 2 torsion, 3 side curvature
  std::string unit;
};

Column column_of(const std::string& field) {
  const auto open = field.find('[');
  const auto close = field.find(']');
  const std::string name = field.substr(0, field.find_first_of(" ["));
  Column c;
  constexpr const char* names[] = {"s", "curvature", "torsion", "side_curvature"};
  for (int i = 0; i < 4; ++i)
    if (name == names[i]) c.quantity = i;
  c.unit = open == std::string::npos || close == std::string::npos || close < open
               ? std::string(c.quantity == 0 ? "m" : "1/m")
               : field.substr(open + 1, close - open - 1);
  return c;
}

constexpr const char* expected =
    "expected columns such as 's [mm], curvature [1/m], torsion [1/m]'";

}  // namespace

RestShape::RestShape(std::vector<RestPiece> pieces) : pieces_(std::move(pieces)) {
  starts_.emplace_back();
  for (std::size_t i = 1; i < pieces_.size(); ++i)
    starts_.push_back(compose(starts_.back(),
                              along_helix(pieces_[i - 1], pieces_[i].from - pieces_[i - 1].from)));
}

Pose RestShape::at(const Pose& origin, Real s) const {
  const auto next = std::upper_bound(pieces_.begin() + 1, pieces_.end(), s,
                                     [](Real x, const RestPiece& p) { return x < p.from; });
  const auto i = static_cast<std::size_t>(next - pieces_.begin()) - 1;
  return compose(compose(origin, starts_[i]), along_helix(pieces_[i], s - pieces_[i].from));
}

std::vector<RestPiece> read_rest_shape(const std::filesystem::path& file, int& line,
                                       std::string& error) {
  constexpr std::size_t most_rows = 100000;
  line = 0;
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) {
    error = "cannot read '" + file.string() + "'";
    return {};
  }
  std::string text;
  std::vector<Column> columns;
  std::vector<RestPiece> pieces;
  const auto fail = [&](const std::string& message) {
    error = message;
    return std::vector<RestPiece>{};
  };
  while (std::getline(in, text)) {
    ++line;
    const std::vector<std::string> fields = fields_of(text);
    if (fields.empty() || (fields.size() == 1 && fields[0].empty()) || fields[0].starts_with('#'))
      continue;
    if (columns.empty()) {
      for (const std::string& field : fields) {
        columns.push_back(column_of(field));
        if (columns.back().quantity < 0)
          return fail("'" + field.substr(0, 40) + "' is no column of a rest shape; " + expected);
      }
      for (const int needed : {0, 1})
        if (std::count_if(columns.begin(), columns.end(),
                          [&](const Column& c) { return c.quantity == needed; }) != 1)
          return fail(std::string("the header must name s and curvature once; ") + expected);
      continue;
    }
    if (fields.size() != columns.size())
      return fail("this row has " + std::to_string(fields.size()) + " numbers, the header " +
                  std::to_string(columns.size()) + " columns");
    RestPiece piece;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const Column& c = columns[i];
      const std::optional<Real> value =
          parse_quantity(fields[i] + ' ' + c.unit, c.quantity == 0 ? "m" : "1/m", error);
      if (!value) return {};
      Real* const quantities[] = {&piece.from, &piece.curvature, &piece.torsion,
                                  &piece.side_curvature};
      *quantities[c.quantity] = *value;
    }
    if (pieces.empty() ? piece.from != 0 : !(piece.from > pieces.back().from))
      return fail(pieces.empty() ? "the first row must be at s = 0, the needle's end"
                                 : "s does not increase from the row before");
    if (pieces.size() == most_rows) return fail("more than 100000 rows");
    pieces.push_back(piece);
  }
  line = 0;
  if (pieces.empty()) return fail(std::string("no rows; ") + expected);
  return pieces;
}

}  // namespace sutura::thread
