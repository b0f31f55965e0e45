// Text for messages and files.
#pragma once

#include <string>
#include <string_view>

namespace sutura {

/// The first `longest` characters and "..." where there are more: names and values from files may
/// be of any length.
std::string shortened(std::string_view text, std::size_t longest = 60);

/// The same in single quotes, for messages: 'text'.
std::string in_quotes(std::string_view text);

/// As the content of an element or of an attribute in double quotes.
std::string xml_escaped(std::string_view text);

}  // namespace sutura
