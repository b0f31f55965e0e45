// The rows H of one body, and the compliance that any body has by solving one column per row.
#include <charconv>

#include "sutura/body.h"

namespace sutura {

void BodyRows::clear() {
  row.clear();
  start.assign(1, 0);
  node.clear();
  value.clear();
}

void BodyRows::add_transposed(const Eigen::Ref<const VecX>& lambda, VecX& force) const {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Real l = lambda[row[i]];
    if (l == 0) continue;
    for (Index e = start[i]; e < start[i + 1]; ++e)
      force.segment(node[static_cast<std::size_t>(e)] * width, width) +=
          l * Eigen::Map<const VecX>(&value[static_cast<std::size_t>(e * width)], width);
  }
}

void BodyRows::add_product(Real scale, const Eigen::Ref<const VecX>& u,
                           Eigen::Ref<VecX> delta) const {
  for (std::size_t i = 0; i < row.size(); ++i)
    for (Index e = start[i]; e < start[i + 1]; ++e)
      delta[row[i]] +=
          (scale * u.segment(node[static_cast<std::size_t>(e)] * width, width))
              .dot(Eigen::Map<const VecX>(&value[static_cast<std::size_t>(e * width)], width));
}

std::optional<int> SolidBody::find_region(const std::string& name_or_tag,
                                          std::string& error) const {
  int tag = 0;
  const char* end = name_or_tag.data() + name_or_tag.size();
  const auto [rest, code] = std::from_chars(name_or_tag.data(), end, tag);
  if (code == std::errc{} && rest == end) return tag;
  error = "'" + name_or_tag + "' is no number, and this solid has no names of regions";
  return {};
}

void Body::add_compliance(const BodyRows& rows, Real dt, Eigen::Ref<MatX> W) const {
  // Few columns at a time: the solve profits from several right-hand sides, the memory stays in
  // cache.
  constexpr Index chunk = 16;
  thread_local MatX columns;  // keeps its memory from step to step
  const Index count = rows.size(), width = rows.width;
  const auto entry = [&](Index e) { return static_cast<std::size_t>(e); };
  columns.resize(dofs(), chunk);
  for (Index first = 0; first < count; first += chunk) {
    const Index now = std::min(chunk, count - first);
    auto block = columns.leftCols(now);
    block.setZero();
    for (Index j = 0; j < now; ++j)
      for (Index e = rows.start[entry(first + j)]; e < rows.start[entry(first + j + 1)]; ++e)
        block.col(j).segment(rows.node[entry(e)] * width, width) +=
            Eigen::Map<const VecX>(&rows.value[entry(e * width)], width);
    solve(block);
    // Upper triangle from the solves, mirrored: W is symmetric to the last bit.
    for (Index j = 0; j < now; ++j)
      for (Index i = 0; i <= first + j; ++i) {
        Real w = 0;
        for (Index e = rows.start[entry(i)]; e < rows.start[entry(i + 1)]; ++e)
          w += block.col(j)
                   .segment(rows.node[entry(e)] * width, width)
                   .dot(Eigen::Map<const VecX>(&rows.value[entry(e * width)], width));
        w *= dt * dt;
        const Index a = rows.row[entry(i)], b = rows.row[entry(first + j)];
        W(a, b) += w;
        if (a != b) W(b, a) += w;
      }
  }
}

}  // namespace sutura
