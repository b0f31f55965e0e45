#include "scene/links.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "scene/builder.h"
#include "sutura/text.h"

namespace sutura {

namespace {

/// "a", "a and b", "a, b and 3 more".
std::string enumerate(const std::vector<std::string>& words) {
  constexpr std::size_t most = 6;
  const std::size_t shown_words = std::min(words.size(), most);
  std::string out;
  for (std::size_t i = 0; i < shown_words; ++i) {
    const bool last = i + 1 == words.size();
    out += (i == 0 ? "" : last ? " and " : ", ") + words[i];
  }
  if (words.size() > most) out += " and " + std::to_string(words.size() - most) + " more";
  return out;
}

class Resolver {
 public:
  Resolver(Scene& scene, const Registry& registry, const std::set<std::string>& failed,
           Diagnostics& diagnostics)
      : scene_(scene), registry_(registry), failed_(failed), diagnostics_(diagnostics) {
    for (Component* component : scene.components()) by_path_.emplace(component->path(), component);
  }

  void resolve(const PendingLink& pending) {
    pending_ = &pending;
    link_ = &pending.owner->info().links[pending.number];
    if (pending.text.empty() && link_->is_named_only) return;
    Component* target = pending.text.empty() ? only_one_in_reach() : named();
    if (target) SceneBuilder::link(scene_, *pending.owner, pending.number, *target);
  }

 private:
  void complain(const std::string& message) {
    diagnostics_.error(pending_->location, pending_->owner->path(), link_->name + ": " + message);
  }

  void collect(const Node& node, std::vector<Component*>& out) const {
    for (const auto& component : node.components)
      if (link_->accepts(*component)) out.push_back(component.get());
    for (const auto& child : node.children) collect(*child, out);
  }

  /// What the link accepts at and below `node`, except its owner. Collected once per link and node,
  /// or a large scene would cost the square of its size.
  std::vector<Component*> candidates(const Node& node) {
    const auto [place, is_new] = candidates_.try_emplace({link_, &node});
    if (is_new) collect(node, place->second);
    std::vector<Component*> out = place->second;
    std::erase(out, pending_->owner);
    return out;
  }

  static std::vector<std::string> paths(const std::vector<Component*>& components) {
    std::vector<std::string> out;
    for (const Component* c : components) out.push_back(c->path());
    return out;
  }

  Component* only_one_in_reach() {
    for (const Node* node = pending_->node; node; node = node->parent) {
      const std::vector<Component*> found = candidates(*node);
      if (found.size() == 1) return found.front();
      if (found.empty()) continue;
      complain("left out, but more than one " + link_->target +
               " is in reach: " + enumerate(paths(found)) + "; say which");
      return nullptr;
    }
    if (link_->is_optional || !failed_.empty()) return nullptr;
    complain("no " + link_->target + " is in the scene" + what_would_do());
    return nullptr;
  }

  /// "; <TetMesh> would do", from trying every component that is enrolled.
  std::string what_would_do() const {
    std::vector<std::string> tags;
    for (const ComponentInfo* info : registry_.components())
      if (link_->accepts(*info->create())) tags.push_back('<' + info->name + '>');
    if (tags.empty()) return "; no plugin of this scene has one";
    return "; " + enumerate(tags) + " would do";
  }

  /// The node or component at the end of the path, as an absolute path; empty if it climbs too far.
  std::string absolute() const {
    std::vector<std::string_view> parts;
    const auto push = [&](std::string_view text) {
      while (!text.empty()) {
        const std::size_t end = std::min(text.find('/'), text.size());
        const std::string_view part = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (part.empty() || part == ".") continue;
        if (part != "..") {
          parts.push_back(part);
        } else if (parts.empty()) {
          return false;
        } else {
          parts.pop_back();
        }
      }
      return true;
    };
    if (!pending_->text.starts_with('/') && !push(pending_->node->path)) return {};
    if (!push(pending_->text)) return {};
    std::string out;
    for (const std::string_view part : parts) out.append("/").append(part);
    return out.empty() ? "/" : out;
  }

  static const Node* find_node(const Node& node, const std::string& path) {
    if (node.path == path) return &node;
    for (const auto& child : node.children)
      if (const Node* found = find_node(*child, path)) return found;
    return nullptr;
  }

  /// Ends a message about a path that will not do: "; did you mean ...?" or the candidates.
  std::string proposals(const std::string& path) {
    constexpr std::size_t enough_errors = 20;  // proposals cost time: hostile input gets no more
    if (diagnostics_.errors() > enough_errors) return {};
    const std::vector<std::string> all = paths(candidates(scene_.root));
    if (all.empty()) return what_would_do();
    const std::string near = nearest_name(path, all);
    if (!near.empty()) return "; did you mean '" + near + "'?";
    return "; a " + link_->target + " is at " + enumerate(all);
  }

  Component* named() {
    const std::string path = absolute();
    const std::string as_written = in_quotes(pending_->text);
    if (path.empty()) {
      complain(as_written + " climbs above the root of the scene");
      return nullptr;
    }
    if (failed_.contains(path)) return nullptr;
    if (const auto found = by_path_.find(path); found != by_path_.end()) {
      Component* component = found->second;
      if (component == pending_->owner) {
        complain(as_written + " is the component itself" + proposals(path));
      } else if (link_->accepts(*component)) {
        return component;
      } else {
        complain(as_written + " is a " + component->info().name + "; expected a " + link_->target +
                 proposals(path));
      }
      return nullptr;
    }
    if (const Node* node = find_node(scene_.root, path)) {
      const std::vector<Component*> found = candidates(*node);
      if (found.size() == 1) return found.front();
      if (found.size() > 1)
        complain("more than one " + link_->target + " is in the node " + as_written + ": " +
                 enumerate(paths(found)) + "; say which");
      else if (failed_.empty())
        complain("the node " + as_written + " has no " + link_->target + proposals(path));
      return nullptr;
    }
    complain("there is nothing at " + as_written + proposals(path));
    return nullptr;
  }

  Scene& scene_;
  const Registry& registry_;
  const std::set<std::string>& failed_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string, Component*> by_path_;
  std::map<std::pair<const LinkInfo*, const Node*>, std::vector<Component*>> candidates_;
  const PendingLink* pending_ = nullptr;
  const LinkInfo* link_ = nullptr;
};

}  // namespace

void resolve_links(Scene& scene, const Registry& registry, const std::vector<PendingLink>& links,
                   const std::set<std::string>& failed, Diagnostics& diagnostics) {
  Resolver resolver(scene, registry, failed, diagnostics);
  for (const PendingLink& link : links) resolver.resolve(link);
}

void check_rings(const Scene& scene, Diagnostics& diagnostics) {
  // Depth-first, without recursion: a chain of links may be as long as the scene.
  enum class State { untouched, open, done };
  std::map<const Component*, State> state;
  struct Visit {
    const Component* component;
    std::size_t next;
  };
  for (const Component* start : scene.components()) {
    if (state[start] != State::untouched) continue;
    std::vector<Visit> stack{{start, 0}};
    state[start] = State::open;
    while (!stack.empty()) {
      Visit& top = stack.back();
      const std::vector<Component*>& links = scene.links_of(*top.component);
      if (top.next == links.size()) {
        state[top.component] = State::done;
        stack.pop_back();
        continue;
      }
      const Component* target = links[top.next++];
      if (state[target] == State::untouched) {
        state[target] = State::open;
        stack.push_back({target, 0});
      } else if (state[target] == State::open) {
        std::string ring = target->path();
        bool inside = false;
        for (const Visit& v : stack) {
          if (inside) ring += " -> " + v.component->path();
          inside = inside || v.component == target;
        }
        diagnostics.error(target->location(), target->path(),
                          "links form a ring: " + ring + " -> " + target->path());
      }
    }
  }
}

}  // namespace sutura
