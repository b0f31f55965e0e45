// From the tree of an XML file to nodes and components. Links come after (links.h).
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/xml_tree.h"
#include "sutura/scene.h"

namespace sutura {

/// A link to resolve once every component exists.
struct PendingLink {
  Component* owner = nullptr;
  Node* node = nullptr;    ///< of the owner
  std::size_t number = 0;  ///< in the description of the owner
  std::string text;        ///< as written; empty when left out
  SourceLocation location;
};

class SceneReader {
 public:
  SceneReader(Scene& scene, Registry& registry, Diagnostics& diagnostics,
              const LoadOptions& options, std::string file);

  void read(const XmlElement& root);

  const std::vector<PendingLink>& links() const { return links_; }
  /// Paths of elements that became nothing because of an error: links to them are not complained
  /// of.
  const std::set<std::string>& failed() const { return failed_; }

 private:
  struct Override {
    std::string path, attribute, value;
    bool used = false;
  };
  struct Value {  ///< an attribute from the file, or what replaces it
    std::string name, text;
    SourceLocation location;
  };

  void take_overrides(const LoadOptions& options);
  void report_unused_overrides();
  void read_settings(const XmlElement& root);
  void read_plugins(const XmlElement& root);
  void read_children(const XmlElement& element, Node& node);
  void read_node(const XmlElement& element, Node& parent, std::set<std::string>& names);
  void read_component(const XmlElement& element, Node& node, std::set<std::string>& names);
  void read_values(const XmlElement& element, Component& component, Node& node,
                   const std::vector<Value>& values);
  void unknown_component(const XmlElement& element, const std::string& path);
  const std::map<std::string, std::string>& elsewhere();

  std::vector<Value> values_of(const XmlElement& element, const std::string& path);
  std::string name_of(const XmlElement& element, const std::string& fallback, const Node& parent,
                      std::set<std::string>& names);
  void reject_text(const XmlElement& element, const std::string& path);
  void reject_children(const XmlElement& element, const std::string& path);
  SourceLocation at(int line) const { return {file_, line}; }
  void error(SourceLocation where, const std::string& path, std::string message);

  Scene& scene_;
  Registry& registry_;
  Diagnostics& diagnostics_;
  std::string file_;
  std::vector<std::string> plugin_directories_;
  std::vector<Override> overrides_;
  std::vector<PendingLink> links_;
  std::set<std::string> failed_;
  std::map<std::string, std::vector<std::string>> attribute_names_;  ///< by path, for --set
  bool all_plugins_loaded_ = true;
  std::map<std::string, std::string> elsewhere_;  ///< tag to plugin, of plugins not named; lazy
  bool looked_elsewhere_ = false;
};

/// "/" + "skin" -> "/skin".
std::string child_path(const std::string& parent, const std::string& name);

}  // namespace sutura
