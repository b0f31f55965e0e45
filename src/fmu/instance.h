// One instance of an FMU: a simulation behind numbered variables. Knows the C API only, as any
// other host.
#pragma once

#include <string>
#include <vector>

#include "fmu/fmi3.h"
#include "sutura/sutura.h"

namespace sutura::fmu {

/// An input and what the importer has set of it. It counts from when it is set between steps;
/// before the first step only a value counts that differs from the one that the model description
/// states, so that an importer that sets all of these changes nothing.
struct Input {
  sutura_input handle = 0;
  std::vector<double> values;
  bool is_set = false;
};

struct Output {
  sutura_output handle = 0;
  std::vector<double> values;  ///< at the end of the last step
  std::string text;            ///< of one that is a text
};

/// A scalar variable: value reference 0 is the time; inputs and outputs follow in the order of the
/// C API, one variable for each number.
struct Variable {
  enum class Kind { time, input, output, text } kind = Kind::time;
  std::size_t owner = 0;  ///< number of the input or output
  std::size_t entry = 0;  ///< which of its numbers
};

class Instance {
 public:
  Instance(std::string name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
      : name_(std::move(name)), environment_(environment), log_(log) {}
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  /// Loads `resources`/scene.xml. False after a message to the importer.
  bool load(const std::string& resources);

  fmi3Status get(const fmi3ValueReference* references, std::size_t count, double* values);
  fmi3Status get(const fmi3ValueReference* references, std::size_t count, fmi3String* values);
  fmi3Status set(const fmi3ValueReference* references, std::size_t count, const double* values);

  void begin(double start) { start_ = start; }
  void begin_steps() { stepping_ = true; }
  void end_steps() { stepping_ = false; }
  /// Steps to `from` + `span`, which must be a whole number of time steps.
  fmi3Status advance(double from, double span);
  double time() const;
  fmi3Status reset();

  /// State, time and inputs as bytes.
  bool save(std::vector<char>& bytes);
  fmi3Status restore(const char* bytes, std::size_t size);

  fmi3Status refuse(const std::string& sentence, fmi3Status status = fmi3Error) const;

 private:
  bool list_variables();
  bool read_outputs();
  const Variable* find(fmi3ValueReference reference) const;

  std::string name_;
  fmi3InstanceEnvironment environment_;
  fmi3LogMessageCallback log_;
  sutura_simulation simulation_ = 0;
  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
  std::vector<Variable> variables_;
  double start_ = 0;  ///< of the importer's clock where that of the scene is 0 (s)
  double dt_ = 0;     ///< s
  bool stepping_ = false;
};

}  // namespace sutura::fmu
