// Components small enough to test the scene layer with: one attribute of every type, links, a ring.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sutura/plugin.h"
#include "sutura/scene.h"

namespace sutura::toys {

struct Shape {
  static constexpr const char* interface_name = "Shape";
  virtual ~Shape() = default;
};

struct Ball : Component, Shape {
  enum class Colour { red, green, blue };
  Real radius = 0.01;
  Real stiffness = 3e3;
  Index count = 2;
  bool hollow = false;
  std::string label;
  File file;
  Vec3 centre = Vec3::Zero();
  std::vector<Real> weights{1, 2};
  Colour colour = Colour::red;
  static void describe(Describe<Ball>& d) {
    d.summary("A ball.");
    d.attribute("radius", &Ball::radius, "m", above(0), "Radius.");
    d.attribute("stiffness", &Ball::stiffness, "Pa", between(0, 1e9), "Stiffness.");
    d.attribute("count", &Ball::count, at_least(1), "Count.");
    d.attribute("hollow", &Ball::hollow, "Hollow or not.");
    d.attribute("label", &Ball::label, "Label.");
    d.attribute("file", &Ball::file, "File.");
    d.attribute("centre", &Ball::centre, "m", any(), "Centre.");
    d.attribute("weights", &Ball::weights, "N/m", at_least(0), "Weights.");
    d.attribute("colour", &Ball::colour, {"red", "green", "blue"}, "Colour.");
  }
};

struct CubeBox : Component, Shape {
  Real edge = 0;
  static void describe(Describe<CubeBox>& d) {
    d.summary("A cube.");
    d.attribute("edge", &CubeBox::edge, "m", above(0), "Edge.").required();
  }
};

struct Rod : Component {
  static constexpr const char* interface_name = "Rod";
  Link<Shape> shape;
  Link<Rod> next;
  static void describe(Describe<Rod>& d) {
    d.summary("A rod through a shape.");
    d.link("shape", &Rod::shape, "Shape.");
    d.link("next", &Rod::next, "Next rod.").optional();
  }
};

struct Mark : Component {
  Link<Shape> shape;
  Link<Rod> rod;
  static void describe(Describe<Mark>& d) {
    d.summary("A mark on a shape, perhaps on a rod too.");
    d.link("rod", &Mark::rod, "Rod.").optional();
    d.link("shape", &Mark::shape, "Shape.");
  }
};

inline Registry registry() {
  Registry r;
  r.component<Ball>("Ball");
  r.component<CubeBox>("CubeBox");
  r.component<Rod>("Rod");
  r.component<Mark>("Mark");
  return r;
}

/// A scene and what was said about it. The registry outlives the scene.
struct Loaded {
  Registry registry = toys::registry();
  Diagnostics diagnostics;
  std::unique_ptr<Scene> scene;

  template <class T>
  T& get(const std::string& path) const {
    return dynamic_cast<T&>(*scene->find(path));
  }
  std::string text() const {
    std::string out;
    for (const Diagnostic& d : diagnostics.all()) out += d.text() + '\n';
    return out;
  }
};

/// `body` stands between the tags of the root element, from line 2 on.
inline std::unique_ptr<Loaded> load(const std::string& body, const LoadOptions& options = {}) {
  auto out = std::make_unique<Loaded>();
  out->scene = load_scene_text("<sutura version=\"1\">\n" + body + "\n</sutura>", "t.xml", "/",
                               out->registry, out->diagnostics, options);
  return out;
}

inline std::unique_ptr<Loaded> load_raw(const std::string& text) {
  auto out = std::make_unique<Loaded>();
  out->scene = load_scene_text(text, "t.xml", "/", out->registry, out->diagnostics);
  return out;
}

}  // namespace sutura::toys
