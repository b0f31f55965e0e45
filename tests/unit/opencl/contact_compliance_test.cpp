// W of rows on nodes of known compliance, against the dense product.
#include "contact_compliance.h"

#include <random>

#include "some_device.h"

namespace sutura::opencl {
namespace {

struct Rows {
  std::vector<std::int32_t> first{0}, place;
  std::vector<Real> value;
  std::vector<Index> row;
  SparseRows view() const { return {first, place, value, row}; }
  /// H, over the unknowns of all known nodes.
  MatX dense(Index unknowns) const {
    MatX H = MatX::Zero(static_cast<Index>(row.size()), unknowns);
    for (std::size_t r = 0; r < row.size(); ++r)
      for (std::int32_t e = first[r]; e < first[r + 1]; ++e)
        for (Index c = 0; c < 3; ++c)
          if (const Index p = place[static_cast<std::size_t>(e)]; p >= 0)
            H(static_cast<Index>(r), 3 * p + c) += value[static_cast<std::size_t>(3 * e + c)];
    return H;
  }
};

class DeviceContactCompliance : public OnDevice {};

// Rows of one to four nodes, some of them fixed; every second row of the problem is another body's,
// or all are the tissue's. Then more nodes become known, and then it is another C of the same size.
TEST_F(DeviceContactCompliance, IsTheDenseProduct) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<Real> some(-1, 1);
  constexpr Index stride = 150, rows = 70;
  MatX all(stride, stride);
  const auto another = [&] {
    MatX B(stride, stride);
    for (Real& b : B.reshaped()) b = some(random);
    all = B * B.transpose() / stride;
  };
  another();
  for (const Precision precision : {Precision::double_, Precision::mixed, Precision::single}) {
    if (has_double_sums(precision) && !device_->has_double()) continue;
    ContactCompliance there(*device_, precision);
    Index id = 0;
    for (const Index known : {90, 90, 120, 150, 150}) {
      if (known == 150) another(), ++id;
      const Index apart = known == 90 ? 2 : 1;
      Rows r;
      for (Index i = 0; i < rows; ++i) {
        for (Index e = 0; e <= i % 4; ++e) {
          const auto place = static_cast<std::int32_t>(random() % static_cast<unsigned>(known / 3));
          r.place.push_back(i % 9 == 8 ? -1 : place);
          for (int c = 0; c < 3; ++c) r.value.push_back(some(random));
        }
        r.first.push_back(static_cast<std::int32_t>(r.place.size()));
        r.row.push_back(apart * i);
      }
      MatX W = MatX::Constant(apart * rows, apart * rows, 0.5), expected = W;
      const MatX H = r.dense(known),
                 product = 0.25 * H * all.topLeftCorner(known, known) * H.transpose();
      for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < rows; ++j) expected(apart * i, apart * j) += product(i, j);
      there.add({id, all.data(), known, stride}, r.view(), 0.25, W);
      EXPECT_LT((W - expected).norm() / expected.norm(), has_double_sums(precision) ? 1e-13 : 1e-6);
      EXPECT_TRUE(W == W.transpose()) << "symmetric to the last bit";
    }
  }
}

}  // namespace
}  // namespace sutura::opencl
