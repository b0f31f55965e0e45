// The text of the .cl files beside this one, which the build puts into the plugin.
#pragma once

namespace sutura::opencl::programs {

extern const char* const laws;
extern const char* const sweep;
extern const char* const solves;
extern const char* const gradients;
extern const char* const elements;
extern const char* const compliance;
extern const char* const direct_step;
extern const char* const batch;
extern const char* const batch_solve;

}  // namespace sutura::opencl::programs
