// One attribute of a component from text and to text.
#pragma once

#include <string>
#include <string_view>

#include "sutura/describe.h"

namespace sutura {

/// Parses, checks the range and stores. False, and a sentence in `error`, if the text will not do.
bool read_attribute(const AttributeInfo& attribute, Component& owner, std::string_view text,
                    std::string& error);

/// The text that reads back as the value `owner` has now; SI, with unit.
std::string write_attribute(const AttributeInfo& attribute, const Component& owner);

/// "above 0 Pa", "between 0 and 0.5"; empty if every number will do.
std::string range_text(const Range& range, const std::string& unit);

/// A name of a node or component: a letter, then letters, digits, '_' and '-'.
bool is_name(std::string_view text);

/// "TetMesh" -> "tet_mesh", "CSVProbe" -> "csv_probe".
std::string default_name(std::string_view tag);

}  // namespace sutura
