// The functions that an importer finds in the FMU.
#include "fmu/fmi3.h"

#include <exception>
#include <memory>

#include "fmu/instance.h"

using sutura::fmu::Instance;

namespace {

/// `f(instance)`, where nothing is thrown across.
template <class F>
fmi3Status on(fmi3Instance instance, const F& f) noexcept {
  if (instance == nullptr) return fmi3Error;
  auto& self = *static_cast<Instance*>(instance);
  try {
    return f(self);
  } catch (const std::exception& e) {
    return self.refuse(e.what(), fmi3Fatal);
  }
}

}  // namespace

FMI3 const char* fmi3GetVersion() {
  return "3.0";
}

FMI3 fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String /*token*/, fmi3String resources, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging*/, fmi3Boolean /*event_mode*/, fmi3Boolean /*early_return*/,
    const fmi3ValueReference* /*intermediate*/, std::size_t /*intermediate_count*/,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback /*update*/) {
  try {
    auto instance = std::make_unique<Instance>(name == nullptr ? "" : name, environment, log);
    if (resources == nullptr) return instance->refuse("there is no resource path"), nullptr;
    return instance->load(resources) ? instance.release() : nullptr;
  } catch (...) {
    return nullptr;
  }
}

FMI3 void fmi3FreeInstance(fmi3Instance instance) {
  delete static_cast<Instance*>(instance);
}

FMI3 fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, std::size_t, const fmi3String*) {
  return fmi3OK;
}

FMI3 fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64,
                                            fmi3Float64 start, fmi3Boolean, fmi3Float64) {
  return on(instance, [&](Instance& self) { return self.begin(start), fmi3OK; });
}

FMI3 fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return on(instance, [](Instance& self) { return self.begin_steps(), fmi3OK; });
}

FMI3 fmi3Status fmi3Terminate(fmi3Instance instance) {
  return on(instance, [](Instance& self) { return self.end_steps(), fmi3OK; });
}

FMI3 fmi3Status fmi3Reset(fmi3Instance instance) {
  return on(instance, [](Instance& self) { return self.reset(); });
}

FMI3 fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from, fmi3Float64 span, fmi3Boolean,
                           fmi3Boolean* event, fmi3Boolean* terminate, fmi3Boolean* early,
                           fmi3Float64* last) {
  return on(instance, [&](Instance& self) {
    const fmi3Status status = self.advance(from, span);
    if (event != nullptr) *event = false;
    if (terminate != nullptr) *terminate = false;
    if (early != nullptr) *early = false;
    if (last != nullptr) *last = self.time();
    return status;
  });
}

FMI3 fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference* references,
                               std::size_t count, fmi3Float64* values, std::size_t) {
  return on(instance, [&](Instance& self) { return self.get(references, count, values); });
}

FMI3 fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference* references,
                               std::size_t count, const fmi3Float64* values, std::size_t) {
  return on(instance, [&](Instance& self) { return self.set(references, count, values); });
}

FMI3 fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference* references,
                              std::size_t count, fmi3String* values, std::size_t) {
  return on(instance, [&](Instance& self) { return self.get(references, count, values); });
}

// An FMU state is a vector of bytes.

FMI3 fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return on(instance, [&](Instance& self) {
    if (state == nullptr) return self.refuse("there is no place for the state");
    auto bytes = std::make_unique<std::vector<char>>();
    if (!self.save(*bytes)) return self.refuse(sutura_error());
    delete static_cast<std::vector<char>*>(*state);
    *state = bytes.release();
    return fmi3OK;
  });
}

FMI3 fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return on(instance, [&](Instance& self) {
    if (state == nullptr) return self.refuse("there is no state");
    const auto& bytes = *static_cast<const std::vector<char>*>(state);
    return self.restore(bytes.data(), bytes.size());
  });
}

FMI3 fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return on(instance, [&](Instance&) {
    if (state == nullptr) return fmi3OK;
    delete static_cast<std::vector<char>*>(*state);
    *state = nullptr;
    return fmi3OK;
  });
}

FMI3 fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state,
                                           std::size_t* size) {
  return on(instance, [&](Instance& self) {
    if (state == nullptr || size == nullptr) return self.refuse("there is no state");
    *size = static_cast<const std::vector<char>*>(state)->size();
    return fmi3OK;
  });
}

FMI3 fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte* bytes,
                                      std::size_t size) {
  return on(instance, [&](Instance& self) {
    if (state == nullptr) return self.refuse("there is no state");
    const auto& from = *static_cast<const std::vector<char>*>(state);
    if (size < from.size()) return self.refuse("the memory for the state is too small");
    std::copy(from.begin(), from.end(), bytes);
    return fmi3OK;
  });
}

FMI3 fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte* bytes,
                                        std::size_t size, fmi3FMUState* state) {
  return on(instance, [&](Instance& self) {
    if (state == nullptr || bytes == nullptr) return self.refuse("there is no state");
    auto fresh = std::make_unique<std::vector<char>>(bytes, bytes + size);
    delete static_cast<std::vector<char>*>(*state);
    *state = fresh.release();
    return fmi3OK;
  });
}

// What the model description says that this FMU does not have. Importers look these names up all
// the same. Further arguments are left where they are.
#define FMI3_NOT_HERE(name)                                                                      \
  FMI3 fmi3Status name(fmi3Instance instance) {                                                  \
    return on(instance,                                                                          \
              [](Instance& self) { return self.refuse("this FMU has no " #name " to offer"); }); \
  }

FMI3 fmi3Instance fmi3InstantiateModelExchange() {
  return nullptr;
}
FMI3 fmi3Instance fmi3InstantiateScheduledExecution() {
  return nullptr;
}
FMI3_NOT_HERE(fmi3EnterEventMode)
FMI3_NOT_HERE(fmi3GetFloat32)
FMI3_NOT_HERE(fmi3GetInt8)
FMI3_NOT_HERE(fmi3GetUInt8)
FMI3_NOT_HERE(fmi3GetInt16)
FMI3_NOT_HERE(fmi3GetUInt16)
FMI3_NOT_HERE(fmi3GetInt32)
FMI3_NOT_HERE(fmi3GetUInt32)
FMI3_NOT_HERE(fmi3GetInt64)
FMI3_NOT_HERE(fmi3GetUInt64)
FMI3_NOT_HERE(fmi3GetBoolean)
FMI3_NOT_HERE(fmi3GetBinary)
FMI3_NOT_HERE(fmi3GetClock)
FMI3_NOT_HERE(fmi3SetFloat32)
FMI3_NOT_HERE(fmi3SetInt8)
FMI3_NOT_HERE(fmi3SetUInt8)
FMI3_NOT_HERE(fmi3SetInt16)
FMI3_NOT_HERE(fmi3SetUInt16)
FMI3_NOT_HERE(fmi3SetInt32)
FMI3_NOT_HERE(fmi3SetUInt32)
FMI3_NOT_HERE(fmi3SetInt64)
FMI3_NOT_HERE(fmi3SetUInt64)
FMI3_NOT_HERE(fmi3SetBoolean)
FMI3_NOT_HERE(fmi3SetString)
FMI3_NOT_HERE(fmi3SetBinary)
FMI3_NOT_HERE(fmi3SetClock)
FMI3_NOT_HERE(fmi3GetNumberOfVariableDependencies)
FMI3_NOT_HERE(fmi3GetVariableDependencies)
FMI3_NOT_HERE(fmi3GetDirectionalDerivative)
FMI3_NOT_HERE(fmi3GetAdjointDerivative)
FMI3_NOT_HERE(fmi3EnterConfigurationMode)
FMI3_NOT_HERE(fmi3ExitConfigurationMode)
FMI3_NOT_HERE(fmi3GetIntervalDecimal)
FMI3_NOT_HERE(fmi3GetIntervalFraction)
FMI3_NOT_HERE(fmi3GetShiftDecimal)
FMI3_NOT_HERE(fmi3GetShiftFraction)
FMI3_NOT_HERE(fmi3SetIntervalDecimal)
FMI3_NOT_HERE(fmi3SetIntervalFraction)
FMI3_NOT_HERE(fmi3SetShiftDecimal)
FMI3_NOT_HERE(fmi3SetShiftFraction)
FMI3_NOT_HERE(fmi3EvaluateDiscreteStates)
FMI3_NOT_HERE(fmi3UpdateDiscreteStates)
FMI3_NOT_HERE(fmi3EnterContinuousTimeMode)
FMI3_NOT_HERE(fmi3CompletedIntegratorStep)
FMI3_NOT_HERE(fmi3SetTime)
FMI3_NOT_HERE(fmi3SetContinuousStates)
FMI3_NOT_HERE(fmi3GetContinuousStateDerivatives)
FMI3_NOT_HERE(fmi3GetEventIndicators)
FMI3_NOT_HERE(fmi3GetContinuousStates)
FMI3_NOT_HERE(fmi3GetNominalsOfContinuousStates)
FMI3_NOT_HERE(fmi3GetNumberOfEventIndicators)
FMI3_NOT_HERE(fmi3GetNumberOfContinuousStates)
FMI3_NOT_HERE(fmi3EnterStepMode)
FMI3_NOT_HERE(fmi3GetOutputDerivatives)
FMI3_NOT_HERE(fmi3ActivateModelPartition)
