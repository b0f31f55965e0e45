#include "precision.h"

namespace sutura::opencl {

Precision choose(Precision asked, const Device& device) {
  if (asked == Precision::automatic)
    return device.has_double() ? Precision::double_ : Precision::single;
  if (asked != Precision::single && !device.has_double())
    throw DeviceError("OpenCL device \"" + device.name() +
                      "\" has no double precision; expected precision=\"single\" or \"auto\"");
  return asked;
}

std::string definitions(Precision precision) {
  const std::string real = has_double_sums(precision) ? "double" : "float";
  return "typedef " + real + " real;\ntypedef " + real + " raw;\ntypedef " +
         (stores_double(precision) ? "double" : "float") + " store;\nconstant real EPSILON = " +
         (has_double_sums(precision) ? "2.220446049250313e-16" : "1.1920929e-7f") + ";\n";
}

}  // namespace sutura::opencl
