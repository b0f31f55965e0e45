#include "scene/xml_tree.h"

#include <tinyxml2.h>

namespace sutura {

namespace {

/// Only names, values and lines are taken: TinyXML2's numbers follow the locale of the process.
XmlElement copy(const tinyxml2::XMLElement& from) {
  XmlElement to;
  to.name = from.Name();
  to.line = from.GetLineNum();
  for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next())
    to.attributes.push_back({a->Name(), a->Value(), a->GetLineNum()});
  for (const tinyxml2::XMLNode* child = from.FirstChild(); child; child = child->NextSibling()) {
    if (const tinyxml2::XMLElement* element = child->ToElement())
      to.children.push_back(copy(*element));  // depth is bounded by check_xml_text
    else if (child->ToText() && to.text_line == 0)
      to.text_line = child->GetLineNum();
  }
  return to;
}

}  // namespace

std::optional<XmlElement> parse_xml(std::string_view text, const std::string& file,
                                    Diagnostics& diagnostics) {
  if (!check_xml_text(text, file, diagnostics)) return std::nullopt;
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    diagnostics.error({file, document.ErrorLineNum()}, "",
                      std::string("this is not well-formed XML: ") + document.ErrorName());
    return std::nullopt;
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (!root) {
    diagnostics.error({file, 0}, "", "the file has no element; expected <sutura version=\"1\">");
    return std::nullopt;
  }
  return copy(*root);
}

}  // namespace sutura
