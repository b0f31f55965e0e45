#include "contact_compliance.h"

#include <algorithm>

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 128;

}  // namespace

ContactCompliance::ContactCompliance(const Device& device, Precision precision)
    : device_(device),
      real_(size_of_sum(precision)),
      program_(device, precision, programs::compliance) {}

/// Only the columns that have been learnt since the last call, unless it is another C.
void ContactCompliance::send_columns(const KnownCompliance& known) {
  if (sent_of_ != known.id || stride_ != known.stride || known.size < sent_) sent_ = 0;
  sent_of_ = known.id;
  stride_ = known.stride;
  if (known.size == sent_) return;
  const auto stride = static_cast<std::size_t>(stride_),
             first = static_cast<std::size_t>(sent_) * stride,
             count = static_cast<std::size_t>(known.size - sent_) * stride;
  if (sent_ == 0) C_.reserve(stride * stride);
  sent_ = known.size;
  C_.write_at(first, {known.C + first, count});
}

void ContactCompliance::add(const KnownCompliance& known, const SparseRows& rows, Real scale,
                            Eigen::Ref<MatX> W) {
  send_columns(known);
  const auto count = static_cast<std::size_t>(rows.first.size() - 1),
             size = static_cast<std::size_t>(known.size), bytes = count * count * real_;
  first_.write(rows.first.data(), rows.first.size_bytes());
  place_.write(rows.place.data(), rows.place.size_bytes());
  h_.write(rows.value);
  Z_.reserve(count * size);
  W_.reserve(bytes);
  if (result_bytes_ < bytes) {
    result_.reset();
    result_bytes_ = std::max(bytes, 2 * result_bytes_);
    result_ = std::make_unique<Pinned>(device_, result_bytes_);
  }
  const auto n = static_cast<cl_int>(count), k = static_cast<cl_int>(size);
  program_["columns_of_rows"](count * size, items, k, static_cast<cl_int>(stride_), n, first_,
                              place_, h_, C_, Z_);
  program_["rows_of_products"](count * count, items, k, n, scale, first_, place_, h_, Z_, W_);
  W_.read(result_->data(), bytes);
  const bool together = rows.row.back() - rows.row.front() + 1 == static_cast<Index>(count);
  const auto add_from = [&](const auto* from) {
    if (together) {
      const auto side = static_cast<Index>(count);
      using Numbers = std::remove_cvref_t<decltype(*from)>;
      const Eigen::Map<const Eigen::Matrix<Numbers, Eigen::Dynamic, Eigen::Dynamic>> all(from, side,
                                                                                         side);
      W.block(rows.row.front(), rows.row.front(), side, side) += all.template cast<Real>();
      return;
    }
    for (std::size_t c = 0; c < count; ++c) {
      auto column = W.col(rows.row[c]);
      for (std::size_t r = 0; r < count; ++r) column[rows.row[r]] += from[c * count + r];
    }
  };
  if (real_ == sizeof(double))
    add_from(static_cast<const double*>(result_->data()));
  else
    add_from(static_cast<const float*>(result_->data()));
}

}  // namespace sutura::opencl
