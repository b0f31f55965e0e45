// XML text to a plain tree. Knows nothing of scenes; refuses what is no well-formed XML and what is
// larger than any scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sutura/diagnostics.h"

namespace sutura {

struct XmlLimits {
  static constexpr std::size_t bytes = std::size_t{16} << 20;
  static constexpr int depth = 64;
  static constexpr int attributes = 64;  ///< of one element
  static constexpr int elements = 10000;
};

struct XmlAttribute {
  std::string name;
  std::string value;
  int line = 0;
};

struct XmlElement {
  std::string name;
  int line = 0;
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;
  int text_line = 0;  ///< where text stands between the tags; 0: nowhere
};

/// The root element, or nothing and an error. What is not well formed is the only error reported:
/// there is no telling what the rest means.
std::optional<XmlElement> parse_xml(std::string_view text, const std::string& file,
                                    Diagnostics& diagnostics);

/// Limits, well-formedness that TinyXML2 does not check, and errors it reports without saying
/// where: NUL bytes, document types, unknown entities, an attribute given twice, tags that do not
/// match. True if `text` may be parsed.
bool check_xml_text(std::string_view text, const std::string& file, Diagnostics& diagnostics);

}  // namespace sutura
