#include "solve/problem_file.h"

#include <cstring>
#include <fstream>

namespace sutura {

namespace {

constexpr char magic[16] = "sutura problem1";  // 15 characters and the final zero
constexpr std::int64_t most_rows = 100000, most_params = 4096;

template <class T>
void put(std::ofstream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof(T));
}
void put(std::ofstream& out, const Real* values, Index count) {
  out.write(reinterpret_cast<const char*>(values), count * static_cast<Index>(sizeof(Real)));
}
template <class T>
T get(std::ifstream& in) {
  T value{};
  in.read(reinterpret_cast<char*>(&value), sizeof(T));
  return value;
}
void get(std::ifstream& in, Real* values, Index count) {
  in.read(reinterpret_cast<char*>(values), count * static_cast<Index>(sizeof(Real)));
}

}  // namespace

std::string write_problem(const ConstraintProblem& problem, const std::string& file) {
  std::ofstream out(file, std::ios::binary);
  if (!out) return "cannot write " + file;
  out.write(magic, sizeof(magic));
  put(out, static_cast<std::int64_t>(problem.blocks.size()));
  put(out, static_cast<std::int64_t>(problem.rows()));
  for (const ConstraintBlock& b : problem.blocks) {
    const std::string name = b.law->name;
    put(out, static_cast<std::int64_t>(name.size()));
    out.write(name.data(), static_cast<std::streamsize>(name.size()));
    put(out, static_cast<std::int64_t>(b.law->params_size));
    out.write(static_cast<const char*>(problem.block_params(b)),
              static_cast<std::streamsize>(b.law->params_size));
    put(out, b.key.value);
    put(out, b.units.force);
    put(out, b.units.length);
    put(out, b.mode);
  }
  put(out, problem.d_free.data(), problem.rows());
  put(out, problem.lambda.data(), problem.rows());
  put(out, problem.W.data(), problem.rows() * problem.rows());
  return out ? "" : "cannot write " + file;
}

std::string read_problem(const std::string& file, std::span<const LawOperations* const> laws,
                         ConstraintProblem& problem) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return "cannot open " + file;
  char head[sizeof(magic)] = {};
  in.read(head, sizeof(head));
  if (std::memcmp(head, magic, sizeof(magic)) != 0) return file + " is not a constraint problem";
  const auto blocks = get<std::int64_t>(in), rows = get<std::int64_t>(in);
  if (!in || blocks < 0 || rows < 0 || blocks > rows || rows > most_rows)
    return file + " has an impossible size";
  problem = {};
  Index row = 0;
  for (std::int64_t i = 0; i < blocks; ++i) {
    ConstraintBlock b;
    const auto length = get<std::int64_t>(in);
    if (!in || length < 0 || length > 256) return file + " is damaged";
    std::string name(static_cast<std::size_t>(length), ' ');
    in.read(name.data(), length);
    for (const LawOperations* law : laws)
      if (name == law->name) b.law = law;
    const auto size = get<std::int64_t>(in);
    if (b.law == nullptr) return file + " has a law '" + name + "' that is not enrolled";
    if (size != static_cast<std::int64_t>(b.law->params_size) || size > most_params)
      return file + ": parameters of '" + name +
             "' have another size; it was written by another build";
    constexpr std::size_t slot = sizeof(std::max_align_t);
    const std::size_t at = problem.params.size();
    b.params = at * slot;
    problem.params.resize(at + (b.law->params_size + slot - 1) / slot);
    in.read(reinterpret_cast<char*>(problem.params.data() + at), size);
    b.key.value = get<std::uint64_t>(in);
    b.units.force = get<Real>(in);
    b.units.length = get<Real>(in);
    b.mode = get<Mode>(in);
    b.first_row = row;
    row += b.law->dim;
    problem.blocks.push_back(b);
  }
  if (!in || row != rows) return file + " is damaged";
  problem.gap.setZero(rows);  // of the guess; not kept
  problem.d_free.resize(rows);
  problem.lambda.resize(rows);
  problem.delta.setZero(rows);
  problem.W.resize(rows, rows);
  get(in, problem.d_free.data(), rows);
  get(in, problem.lambda.data(), rows);
  get(in, problem.W.data(), rows * rows);
  return in ? "" : file + " is cut short";
}

}  // namespace sutura
