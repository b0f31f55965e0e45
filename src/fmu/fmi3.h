// The part of the Functional Mock-up Interface 3.0 (fmi-standard.org) that an FMU for co-simulation
// defines: types and signatures as the standard states them.
#pragma once

#include <cstddef>
#include <cstdint>

#define FMI3 extern "C" __attribute__((visibility("default")))

using fmi3Instance = void*;
using fmi3InstanceEnvironment = void*;
using fmi3FMUState = void*;
using fmi3ValueReference = std::uint32_t;
using fmi3Float64 = double;
using fmi3Boolean = bool;
using fmi3String = const char*;
using fmi3Byte = std::uint8_t;

enum fmi3Status { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal };

using fmi3LogMessageCallback = void (*)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                        fmi3String message);
using fmi3IntermediateUpdateCallback = void (*)();  // never called
