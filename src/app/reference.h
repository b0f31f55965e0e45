// The reference of components, made from their descriptions: for a terminal, as Markdown, as XML
// schema.
#pragma once

#include <string>

#include "sutura/registry.h"

namespace sutura::app {

/// One component, for a terminal.
std::string plain_text(const ComponentInfo& info, const Registry& registry);
/// Plugins and their components with a line each, for a terminal.
std::string plain_index(const Registry& registry);

/// `example` is the text of a scene, or empty.
std::string markdown_page(const ComponentInfo& info, const Registry& registry,
                          const std::string& example);
std::string markdown_index(const Registry& registry);

/// Validates scenes that use the components of `registry`.
std::string xml_schema(const Registry& registry);

/// "real", "list of reals", "one of `a`, `b`" ...
std::string type_text(const AttributeInfo& attribute, const char* quote);
/// The value that a new component has, or empty where there is none to speak of.
std::string default_text(const ComponentInfo& info, const AttributeInfo& attribute);
/// Names of the components that a link accepts.
std::vector<std::string> accepted_by(const LinkInfo& link, const Registry& registry);

}  // namespace sutura::app
