// What a component must remember from step to step, said once for saving and for restoring:
//
//   void archive(Archive& a) override {
//     a("positions", x_);
//     a("punctures", punctures_);
//     a.list("samples", samples_, [](Archive& a, Sample& s) {
//       a("depth", s.depth);
//       a("kind", s.kind);
//     });
//   }
//
// Every value is stored with its name, type and size, and restored only into the same name and type
// in the same order. Nothing is read beyond the end. After the first mismatch nothing more is read:
// `problem` says what it was, and the state is then half old and half new and must not be used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sutura/types.h"

namespace sutura {

struct EmbeddedPoint;

class Archive {
 public:
  /// One that saves; `bytes` is what it has so far.
  Archive() = default;
  /// One that restores from `saved`, which must outlive it.
  explicit Archive(std::span<const std::byte> saved) : saved_(saved), restoring_(true) {}

  bool restoring() const { return restoring_; }
  /// Restoring: all of it has been read, and all of it matched.
  bool finished() const { return ok() && at_ == saved_.size(); }
  bool ok() const { return problem_.empty(); }
  /// The first thing that did not match, in a sentence, or empty.
  const std::string& problem() const { return problem_; }
  /// For a component that finds what it restored unusable.
  void fail(std::string sentence);
  const std::vector<std::byte>& bytes() const { return bytes_; }

  /// Numbers, flags, enumerations.
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void operator()(std::string_view name,
                                                                         T& value) {
    fixed(name, type_of<T>(), sizeof(T), 1, 1, &value);
  }
  void operator()(std::string_view name, std::string& text);
  void operator()(std::string_view name, Quat& q) {
    fixed(name, type_of<Real>(), sizeof(Real), 4, 1, q.coeffs().data());
  }
  void operator()(std::string_view name, Pose& pose);
  void operator()(std::string_view name, Wrench& wrench);
  void operator()(std::string_view name, EmbeddedPoint& point);

  /// Vectors and matrices of numbers; one whose size is not fixed takes the size that was saved.
  template <class T, int R, int C, int O, int MR, int MC>
  void operator()(std::string_view name, Eigen::Matrix<T, R, C, O, MR, MC>& m) {
    if constexpr (R != Eigen::Dynamic && C != Eigen::Dynamic) {
      fixed(name, type_of<T>(), sizeof(T), R, C, m.data());
    } else {
      Index rows = m.rows(), columns = m.cols();
      if (!begin(name, type_of<T>(), sizeof(T), rows, columns)) return;
      if ((R != Eigen::Dynamic && rows != R) || (C != Eigen::Dynamic && columns != C)) {
        fail("'" + std::string(name) + "' has the wrong shape");
        return;
      }
      if (restoring_) m.resize(rows, columns);
      copy(m.data(), static_cast<std::size_t>(m.size()) * sizeof(T));
    }
  }
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void operator()(std::string_view name,
                                                                         std::vector<T>& values) {
    Index rows = static_cast<Index>(values.size()), columns = 1;
    if (!begin(name, type_of<T>(), sizeof(T), rows, columns)) return;
    if (restoring_) values.resize(static_cast<std::size_t>(rows * columns));
    copy(values.data(), values.size() * sizeof(T));
  }
  /// Matrices of one fixed size.
  template <class T, int R, int C>
  void operator()(std::string_view name, std::vector<Eigen::Matrix<T, R, C>>& values) {
    using M = Eigen::Matrix<T, R, C>;
    static_assert(sizeof(M) == R * C * sizeof(T), "no gaps between the matrices");
    Index rows = static_cast<Index>(values.size()), columns = R * C;
    if (!begin(name, type_of<T>(), sizeof(T), rows, columns)) return;
    if (columns != R * C) return fail("'" + std::string(name) + "' has the wrong shape");
    if (restoring_) values.resize(static_cast<std::size_t>(rows));
    copy(values.data(), values.size() * sizeof(M));
  }
  /// Things that are more than a number: `each(archive, thing)` archives one of them.
  template <class T, class F>
  void list(std::string_view name, std::vector<T>& things, F each) {
    Index count = static_cast<Index>(things.size()), columns = 1;
    if (!begin(name, 'l', 1, count, columns)) return;
    if (restoring_) things.resize(static_cast<std::size_t>(count));
    for (T& thing : things) {
      if (!ok()) return;
      each(*this, thing);
    }
  }

 private:
  template <class T>
  static constexpr char type_of() {
    static_assert(!std::is_floating_point_v<T> || std::is_same_v<T, Real>);
    return std::is_same_v<T, Real> ? 'r' : std::is_same_v<T, bool> ? 'b' : 'i';
  }
  /// Name, type and size of what follows. Restoring: the size that was saved, and false if name or
  /// type differ or what follows would reach beyond the end.
  bool begin(std::string_view name, char type, std::size_t size, Index& rows, Index& columns);
  void copy(void* data, std::size_t size);
  void fixed(std::string_view name, char type, std::size_t size, Index rows, Index columns,
             void* data);
  bool read(void* to, std::size_t size);

  std::vector<std::byte> bytes_;
  std::span<const std::byte> saved_;
  std::size_t at_ = 0;
  bool restoring_ = false;
  std::string problem_;
};

}  // namespace sutura
