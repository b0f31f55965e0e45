#include "sutura/text.h"

namespace sutura {

std::string shortened(std::string_view text, std::size_t longest) {
  return std::string(text.substr(0, longest)) + (text.size() > longest ? "..." : "");
}

std::string in_quotes(std::string_view text) {
  return "'" + shortened(text) + "'";
}

std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace sutura
