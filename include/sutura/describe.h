// `describe` is written once per component and gives the parser, range check, unit, error text,
// generated reference, XSD and writer:
//
//   struct Tissue : Component {
//     Real young = 3e3;
//     static void describe(Describe<Tissue>& d) {
//       d.summary("Corotational tetrahedral tissue, implicit Euler.");
//       d.attribute("young", &Tissue::young, "Pa", above(0), "Young modulus.");
//       d.link("mesh", &Tissue::mesh, "Rest shape.");
//       d.output("sag", "m", "Lowest point.", [](const Tissue& t) { return t.sag(); });
//     }
//   };
#pragma once

#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "sutura/component.h"

namespace sutura {

/// Admissible values of a number (of every entry of a list).
struct Range {
  Real low = -std::numeric_limits<Real>::infinity();
  Real high = std::numeric_limits<Real>::infinity();
  bool low_open = false;
  bool high_open = false;
  bool contains(Real x) const {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
};
inline Range any() {
  return {};
}
inline Range above(Real low) {
  return {.low = low, .low_open = true};
}
inline Range at_least(Real low) {
  return {.low = low};
}
inline Range between(Real low, Real high) {
  return {.low = low, .high = high};
}
inline Range strictly_between(Real low, Real high) {
  return {.low = low, .high = high, .low_open = true, .high_open = true};
}

/// A path in the text of a scene; relative ones are resolved with Setup::resolve.
struct File {
  std::string path;
};

/// How an attribute is stored in the component; decides how its text is read.
enum class AttributeType { real, integer, flag, text, file, vec3, reals, choice };

struct AttributeInfo {
  std::string name;
  AttributeType type = AttributeType::real;
  std::string unit;  ///< SI unit of a real, vec3 or reals; empty otherwise
  Range range;       ///< of each number
  std::string doc;   ///< one sentence
  bool is_required = false;
  std::vector<std::string> choices;  ///< of a choice, in the order of the enumerators 0, 1, ...
  /// Where the value lives: Real, Index, bool, std::string, File, Vec3, std::vector<Real>; a choice
  /// is read and written through `get_choice` and `set_choice`.
  std::function<void*(Component&)> member;
  std::function<int(const Component&)> get_choice;
  std::function<void(Component&, int)> set_choice;

  AttributeInfo& required() {
    is_required = true;
    return *this;
  }
};

struct LinkInfo {
  std::string name;
  std::string target;  ///< name of the interface, for messages and docs
  std::string doc;
  bool is_optional = false;
  bool is_named_only = false;
  std::function<bool(Component& candidate)> accepts;
  std::function<void(Component& owner, Component& target)> assign;

  /// Left out in the text, the link stays empty when nothing of its type is in reach; more than one
  /// candidate in reach is still an error.
  LinkInfo& optional() {
    is_optional = true;
    return *this;
  }
  /// Left out in the text, the link stays empty, whatever is in reach.
  LinkInfo& named_only() {
    is_optional = is_named_only = true;
    return *this;
  }
};

/// A value that recorders can read after each step.
using OutputValue = std::variant<Real, Vec3, std::string>;

struct OutputInfo {
  std::string name;
  std::string unit;
  std::string doc;
  std::function<OutputValue(const Component&)> read;
};

/// A value that a host sets between two steps. The next step is the first to feel it.
using InputValue = std::variant<Real, Vec3>;

struct InputInfo {
  std::string name;
  std::string unit;
  std::string doc;
  Range range;             ///< of each number
  bool is_vector = false;  ///< three numbers, not one
  std::function<void(Component&, const InputValue&)> write;
};

struct ComponentInfo {
  std::string name;     ///< tag in XML
  std::string plugin;   ///< the room it comes from; "core" for built-in ones
  std::string summary;  ///< one or two sentences
  std::string theory;   ///< equations and sources, Markdown; may be empty
  std::vector<AttributeInfo> attributes;
  std::vector<LinkInfo> links;
  std::vector<InputInfo> inputs;
  std::vector<OutputInfo> outputs;
  std::function<std::unique_ptr<Component>()> create;
};

/// An output found by name: reads it again and again without looking it up.
struct OutputHandle {
  const Component* component = nullptr;
  const OutputInfo* info = nullptr;
  explicit operator bool() const { return info != nullptr; }
  /// What throws in there is said to be that component's fault, and not that of who reads it.
  OutputValue read() const;
};

/// An input found by name.
class InputHandle {
 public:
  InputHandle() = default;
  InputHandle(Component& component, const InputInfo& info) : component_(&component), info_(&info) {}
  explicit operator bool() const { return info_ != nullptr; }
  const InputInfo& info() const { return *info_; }
  /// What is wrong with the value (out of range, not finite, a number for a vector), in a sentence,
  /// or empty: it is set.
  std::string set(const InputValue& value) const;

 private:
  Component* component_ = nullptr;
  const InputInfo* info_ = nullptr;
};

template <class T>
class Describe {
 public:
  explicit Describe(ComponentInfo& info) : info_(info) {}

  void summary(std::string text) { info_.summary = std::move(text); }
  void theory(std::string markdown) { info_.theory = std::move(markdown); }

  /// Real, Vec3 or std::vector<Real>, with unit.
  template <class V>
  AttributeInfo& attribute(std::string name, V T::*member, std::string unit, Range range,
                           std::string doc) {
    AttributeInfo& a = add(std::move(name), numeric_type<V>(), member, std::move(doc));
    a.unit = std::move(unit);
    a.range = range;
    return a;
  }
  /// A count.
  AttributeInfo& attribute(std::string name, Index T::*member, Range range, std::string doc) {
    AttributeInfo& a = add(std::move(name), AttributeType::integer, member, std::move(doc));
    a.range = range;
    return a;
  }
  AttributeInfo& attribute(std::string name, bool T::*member, std::string doc) {
    return add(std::move(name), AttributeType::flag, member, std::move(doc));
  }
  AttributeInfo& attribute(std::string name, std::string T::*member, std::string doc) {
    return add(std::move(name), AttributeType::text, member, std::move(doc));
  }
  AttributeInfo& attribute(std::string name, File T::*member, std::string doc) {
    return add(std::move(name), AttributeType::file, member, std::move(doc));
  }
  /// One word out of a list; the enumerators of E are 0, 1, 2, ... in the order of `words`.
  template <class E>
  requires std::is_enum_v<E> AttributeInfo& attribute(std::string name, E T::*member,
                                                      std::vector<std::string> words,
                                                      std::string doc) {
    AttributeInfo& a = add(std::move(name), AttributeType::choice, member, std::move(doc));
    a.choices = std::move(words);
    a.get_choice = [member](const Component& c) {
      return static_cast<int>(dynamic_cast<const T&>(c).*member);
    };
    a.set_choice = [member](Component& c, int i) {
      dynamic_cast<T&>(c).*member = static_cast<E>(i);
    };
    return a;
  }

  /// L is a component or an interface with `static constexpr const char* interface_name`.
  template <class L>
  LinkInfo& link(std::string name, Link<L> T::*member, std::string doc) {
    LinkInfo l;
    l.name = std::move(name);
    l.target = L::interface_name;
    l.doc = std::move(doc);
    l.accepts = [](Component& c) { return dynamic_cast<L*>(&c) != nullptr; };
    l.assign = [member](Component& owner, Component& target) {
      (dynamic_cast<T&>(owner).*member).set(dynamic_cast<L*>(&target));
    };
    info_.links.push_back(std::move(l));
    return info_.links.back();
  }

  /// `write` takes a T& and a Real or a Vec3, whose numbers are in `range`.
  template <class F>
  void input(std::string name, std::string unit, Range range, std::string doc, F write) {
    InputInfo i{std::move(name), std::move(unit), std::move(doc), range, false, {}};
    i.is_vector = !std::is_invocable_v<F, T&, Real>;
    i.write = [write](Component& c, const InputValue& value) {
      if constexpr (std::is_invocable_v<F, T&, Real>)
        write(dynamic_cast<T&>(c), std::get<Real>(value));
      else
        write(dynamic_cast<T&>(c), std::get<Vec3>(value));
    };
    info_.inputs.push_back(std::move(i));
  }

  /// `read` takes a const T& and returns Real, Vec3 or std::string.
  template <class F>
  void output(std::string name, std::string unit, std::string doc, F read) {
    info_.outputs.push_back(
        {std::move(name), std::move(unit), std::move(doc),
         [read](const Component& c) -> OutputValue { return read(dynamic_cast<const T&>(c)); }});
  }

 private:
  template <class V>
  static constexpr AttributeType numeric_type() {
    if constexpr (std::is_same_v<V, Real>)
      return AttributeType::real;
    else if constexpr (std::is_same_v<V, Vec3>)
      return AttributeType::vec3;
    else {
      static_assert(std::is_same_v<V, std::vector<Real>>, "Real, Vec3 or std::vector<Real>");
      return AttributeType::reals;
    }
  }
  template <class V>
  AttributeInfo& add(std::string name, AttributeType type, V T::*member, std::string doc) {
    AttributeInfo a;
    a.name = std::move(name);
    a.type = type;
    a.doc = std::move(doc);
    a.member = [member](Component& c) -> void* { return &(dynamic_cast<T&>(c).*member); };
    info_.attributes.push_back(std::move(a));
    return info_.attributes.back();
  }

  ComponentInfo& info_;
};

}  // namespace sutura
