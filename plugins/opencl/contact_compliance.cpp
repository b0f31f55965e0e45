#include "contact_compliance.h"

#include <algorithm>

#include "programs.h"

namespace sutura::opencl {
namespace {

constexpr std::size_t items = 128;

}  // namespace

struct ContactCompliance::Program {
  Program(const Device& device, Precision precision)
      : program(device.build(definitions(precision) + programs::compliance, "")),
        columns(device, program, "columns_of_rows"),
        products(device, program, "rows_of_products") {}
  ~Program() { clReleaseProgram(program); }
  cl_program program;
  Kernel columns, products;
};

ContactCompliance::ContactCompliance(const Device& device, Precision precision)
    : device_(device),
      precision_(precision),
      C_(device),
      first_(device),
      place_(device),
      h_(device),
      Z_(device),
      W_(device) {}

ContactCompliance::~ContactCompliance() = default;

void ContactCompliance::send(Buffer& to, std::span<const Real> from) {
  if (has_double_sums(precision_)) return to.write(from.data(), from.size_bytes());
  rounded_.assign(from.begin(), from.end());
  to.write(rounded_);
  device_.finish();  // `rounded_` may change from now on
}

/// Only the columns that have been learnt since the last call, unless it is another C.
void ContactCompliance::send_columns(const KnownCompliance& known) {
  if (sent_of_ != known.id || stride_ != known.stride || known.size < sent_) sent_ = 0;
  sent_of_ = known.id;
  stride_ = known.stride;
  if (known.size == sent_) return;
  const std::size_t real = has_double_sums(precision_) ? 8 : 4,
                    stride = static_cast<std::size_t>(stride_),
                    first = static_cast<std::size_t>(sent_) * stride,
                    count = static_cast<std::size_t>(known.size - sent_) * stride;
  if (sent_ == 0) C_.reserve(stride * stride * real);
  sent_ = known.size;
  if (has_double_sums(precision_)) {
    C_.write_at(first * real, known.C + first, count * real);
  } else {
    rounded_.assign(known.C + first, known.C + first + count);
    C_.write_at(first * real, rounded_.data(), count * real);
    device_.finish();
  }
}

void ContactCompliance::add(const KnownCompliance& known, const SparseRows& rows, Real scale,
                            Eigen::Ref<MatX> W) {
  if (!program_) program_ = std::make_unique<Program>(device_, precision_);
  send_columns(known);
  const auto count = static_cast<std::size_t>(rows.first.size() - 1),
             size = static_cast<std::size_t>(known.size);
  const std::size_t real = has_double_sums(precision_) ? 8 : 4, bytes = count * count * real;
  first_.write(rows.first.data(), rows.first.size_bytes());
  place_.write(rows.place.data(), rows.place.size_bytes());
  send(h_, rows.value);
  Z_.reserve(count * size * real);
  W_.reserve(bytes);
  if (result_bytes_ < bytes) {
    result_.reset();
    result_bytes_ = std::max(bytes, 2 * result_bytes_);
    result_ = std::make_unique<Pinned>(device_, result_bytes_);
  }
  const auto n = static_cast<cl_int>(count), k = static_cast<cl_int>(size);
  program_->columns(count * size, items, k, static_cast<cl_int>(stride_), n, first_, place_, h_, C_,
                    Z_);
  const auto run = [&](auto scale_) {
    program_->products(count * count, items, k, n, scale_, first_, place_, h_, Z_, W_);
  };
  if (has_double_sums(precision_))
    run(scale);
  else
    run(static_cast<float>(scale));
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
  if (has_double_sums(precision_))
    add_from(static_cast<const double*>(result_->data()));
  else
    add_from(static_cast<const float*>(result_->data()));
}

}  // namespace sutura::opencl
