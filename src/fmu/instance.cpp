#include "fmu/instance.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sutura::fmu {
namespace {

// The bytes of an FMU state: the start and whether steps are taken; for each input whether it is
// set, and its numbers; the state of the simulation.

void append(std::vector<char>& bytes, const void* data, std::size_t size) {
  const char* const begin = static_cast<const char*>(data);
  bytes.insert(bytes.end(), begin, begin + size);
}

template <class T>
bool take(const char*& at, const char* end, T& value) {
  if (static_cast<std::size_t>(end - at) < sizeof value) return false;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return true;
}

sutura_report report_of(sutura_simulation simulation) {
  sutura_report report{};
  report.struct_size = sizeof report;
  sutura_get_report(simulation, &report);
  return report;
}

}  // namespace

Instance::~Instance() {
  if (simulation_ != 0) sutura_destroy(simulation_);
}

fmi3Status Instance::refuse(const std::string& sentence, fmi3Status status) const {
  if (log_ != nullptr)
    log_(environment_, status, status == fmi3Warning ? "logStatusWarning" : "logStatusError",
         (name_ + ": " + sentence).c_str());
  return status;
}

bool Instance::load(const std::string& resources) {
  // Our own plugins: libsutura may be that of another FMU in this process, whose folder is gone.
  Dl_info info{};
  dladdr(reinterpret_cast<const void*>(&report_of), &info);
  std::string folder = info.dli_fname == nullptr ? "" : info.dli_fname;
  folder = folder.substr(0, folder.rfind('/') + 1) + "sutura";
  const char* const folders[] = {folder.c_str()};
  sutura_options options{};
  options.plugin_directories = folders;
  options.plugin_directory_count = 1;
  options.struct_size = sizeof options;
  options.api = SUTURA_API;
  options.user = this;
  options.message = [](void* user, std::int32_t severity, const char* text) {
    const auto& self = *static_cast<const Instance*>(user);
    if (severity == SUTURA_WARNING) self.refuse(text, fmi3Warning);
  };
  if (sutura_api() != SUTURA_API) {
    refuse("another version of Sutura is in this process");
    return false;
  }
  if (sutura_load((resources + "/scene.xml").c_str(), &options, &simulation_) != SUTURA_OK ||
      !list_variables()) {
    refuse(sutura_error());
    return false;
  }
  return true;
}

bool Instance::list_variables() {
  dt_ = report_of(simulation_).dt;
  variables_.assign(1, {});
  std::size_t count = 0;
  if (sutura_input_count(simulation_, &count) != SUTURA_OK) return false;
  inputs_.resize(count);
  sutura_value about{};
  about.struct_size = sizeof about;
  for (std::size_t i = 0; i < count; ++i) {
    Input& input = inputs_[i];
    if (sutura_input_at(simulation_, i, &input.handle) != SUTURA_OK ||
        sutura_describe_input(input.handle, &about) != SUTURA_OK)
      return false;
    // As the model description has it: where it is now, if there is an output of the same name.
    input.values.assign(about.size, std::clamp(0.0, about.low, about.high));
    const std::string name = std::string(about.path) + '.' + about.name;
    sutura_output same = 0;
    if (sutura_find_output(simulation_, name.c_str(), &same) == SUTURA_OK)
      sutura_get_output(same, input.values.data(), input.values.size());
    for (std::size_t k = 0; k < about.size; ++k)
      variables_.push_back({Variable::Kind::input, i, k});
  }
  if (sutura_output_count(simulation_, &count) != SUTURA_OK) return false;
  outputs_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Output& output = outputs_[i];
    if (sutura_output_at(simulation_, i, &output.handle) != SUTURA_OK ||
        sutura_describe_output(output.handle, &about) != SUTURA_OK)
      return false;
    output.values.resize(about.size);
    if (about.size == 0) variables_.push_back({Variable::Kind::text, i, 0});
    for (std::size_t k = 0; k < about.size; ++k)
      variables_.push_back({Variable::Kind::output, i, k});
  }
  return read_outputs();
}

bool Instance::read_outputs() {
  for (Output& output : outputs_) {
    const char* text = nullptr;
    const bool is_text = output.values.empty();
    if (is_text ? sutura_get_text(output.handle, &text) != SUTURA_OK
                : sutura_get_output(output.handle, output.values.data(), output.values.size()) !=
                      SUTURA_OK)
      return false;
    if (is_text) output.text = text;
  }
  return true;
}

const Variable* Instance::find(fmi3ValueReference reference) const {
  return reference < variables_.size() ? &variables_[reference] : nullptr;
}

fmi3Status Instance::get(const fmi3ValueReference* references, std::size_t count, double* values) {
  for (std::size_t i = 0; i < count; ++i) {
    const Variable* const v = find(references[i]);
    if (v == nullptr || v->kind == Variable::Kind::text)
      return refuse("there is no number with value reference " + std::to_string(references[i]));
    values[i] = v->kind == Variable::Kind::time    ? time()
                : v->kind == Variable::Kind::input ? inputs_[v->owner].values[v->entry]
                                                   : outputs_[v->owner].values[v->entry];
  }
  return fmi3OK;
}

fmi3Status Instance::get(const fmi3ValueReference* references, std::size_t count,
                         fmi3String* values) {
  for (std::size_t i = 0; i < count; ++i) {
    const Variable* const v = find(references[i]);
    if (v == nullptr || v->kind != Variable::Kind::text)
      return refuse("there is no text with value reference " + std::to_string(references[i]));
    values[i] = outputs_[v->owner].text.c_str();
  }
  return fmi3OK;
}

fmi3Status Instance::set(const fmi3ValueReference* references, std::size_t count,
                         const double* values) {
  for (std::size_t i = 0; i < count; ++i) {
    const Variable* const v = find(references[i]);
    if (v == nullptr || v->kind != Variable::Kind::input)
      return refuse("there is no input with value reference " + std::to_string(references[i]));
    Input& input = inputs_[v->owner];
    if (!stepping_ && input.values[v->entry] == values[i]) continue;
    input.values[v->entry] = values[i];
    input.is_set = true;
  }
  return fmi3OK;
}

double Instance::time() const {
  return start_ + report_of(simulation_).time;
}

fmi3Status Instance::advance(double from, double span) {
  if (!stepping_)
    return refuse("a step is taken between fmi3ExitInitializationMode and fmi3Terminate only");
  // Parts of a step that the sums of an importer's clock may be off.
  constexpr double rounding = 1e-6;
  if (!(std::abs(from - time()) <= rounding * dt_))
    return refuse("the step begins at " + std::to_string(from) + " s; the simulation is at " +
                  std::to_string(time()) + " s");
  const double steps = std::round(span / dt_);
  if (!(steps >= 1 && std::abs(span - steps * dt_) <= rounding * dt_))
    return refuse("a communication step of " + std::to_string(span) +
                  " s is no whole number of time steps of " + std::to_string(dt_) + " s");
  for (const Input& input : inputs_)
    if (input.is_set &&
        sutura_set_input(input.handle, input.values.data(), input.values.size()) != SUTURA_OK)
      return refuse(sutura_error());
  const std::int64_t before = report_of(simulation_).missed;
  if (sutura_step(simulation_, static_cast<std::size_t>(steps)) != SUTURA_OK || !read_outputs())
    return refuse(sutura_error());
  // What was wrong has been logged.
  return report_of(simulation_).missed > before ? fmi3Warning : fmi3OK;
}

fmi3Status Instance::reset() {
  start_ = 0;
  stepping_ = false;
  if (sutura_reset(simulation_) != SUTURA_OK || !list_variables()) return refuse(sutura_error());
  for (Input& input : inputs_) input.is_set = false;
  return fmi3OK;
}

bool Instance::save(std::vector<char>& bytes) {
  const void* state = nullptr;
  std::size_t size = 0;
  if (sutura_save(simulation_, &state, &size) != SUTURA_OK) return false;
  bytes.clear();
  append(bytes, &start_, sizeof start_);
  append(bytes, &stepping_, sizeof stepping_);
  for (const Input& input : inputs_) {
    bytes.push_back(input.is_set ? 1 : 0);
    append(bytes, input.values.data(), input.values.size() * sizeof(double));
  }
  append(bytes, state, size);
  return true;
}

fmi3Status Instance::restore(const char* bytes, std::size_t size) {
  const char* at = bytes;
  const char* const end = bytes + size;
  std::vector<Input> inputs = inputs_;
  double start = 0;
  bool stepping = false;
  bool whole = take(at, end, start) && take(at, end, stepping);
  for (Input& input : inputs) {
    char is_set = 0;
    whole = whole && take(at, end, is_set);
    input.is_set = is_set != 0;
    for (double& value : input.values) whole = whole && take(at, end, value);
  }
  if (!whole) return refuse("the state is cut short");
  if (sutura_restore(simulation_, at, static_cast<std::size_t>(end - at)) != SUTURA_OK ||
      !read_outputs())
    return refuse(sutura_error());
  start_ = start;
  stepping_ = stepping;
  inputs_ = std::move(inputs);
  return fmi3OK;
}

}  // namespace sutura::fmu
