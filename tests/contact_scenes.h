// Pieces of scenes on contact, as text.
#pragma once

#include <iomanip>
#include <sstream>
#include <string>

#include "sutura/types.h"

namespace sutura::testing {

inline std::string text_of(const Vec3& v) {
  std::ostringstream s;
  s << std::setprecision(17) << v.x() << ' ' << v.y() << ' ' << v.z();
  return s.str();
}

/// A straight thread without needle, 4-0 and 0.2 mm thick. `more`: other attributes. In metres.
inline std::string thread(const std::string& name, const Vec3& middle, const Vec3& along,
                          Real length, int beams, const std::string& more = "") {
  return "<SutureThread name='" + name +
         "' needle_length='0' thread='4-0 polypropylene' thread_diameter='0.2 mm' thread_length='" +
         std::to_string(length) + "' thread_beams='" + std::to_string(beams) + "' tip='" +
         text_of(middle - length / 2 * along) + "' tip_direction='" + text_of(-along) + "' " +
         more + "/>";
}

/// A block of tissue, /NAME/tissue, of 20 kPa. `box` in mm; `more`: other components in its node.
inline std::string block(const std::string& name, const std::string& box, const std::string& cells,
                         const std::string& more = "", const std::string& poisson = "0.3") {
  return "<node name='" + name + "'><BlockMesh box='" + box + " mm' cells='" + cells +
         "'/><Tissue name='tissue' young='20 kPa' poisson='" + poisson +
         "' density='1000' damping_stiffness='10 ms'/>" + more + "</node>";
}

}  // namespace sutura::testing
