#include "tissue.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "attach.h"
#include "corotational_t4.h"
#include "direct_solver.h"
#include "free_motion.h"
#include "material_limits.h"
#include "smoothed_t4.h"
#include "sutura/archive.h"
#include "sutura/cache.h"
#include "sutura/scene.h"
#include "tissue_statics.h"

namespace sutura::tissue {
namespace {

constexpr Real longest_tissue = 5;          // m; what is longer is doubted by itself
constexpr std::size_t most_tets = 1000000;  // some 4 GB with matrix and factor

/// Which nodes an element couples.
struct PatternKey {
  std::shared_ptr<const RestShape> shape;
  bool smoothed;
  bool operator==(const PatternKey&) const = default;
};

}  // namespace

void Tissue::describe(Describe<Tissue>& d) {
  d.summary("Soft tissue: corotational tetrahedra, lumped mass, implicit Euler.");
  d.attribute("young", &Tissue::young, "Pa", young_range,
              "Young modulus, where no Layer says otherwise.");
  d.attribute("poisson", &Tissue::poisson, "1", strictly_between(-1, 0.5),
              "Poisson ratio; linear elements grow too stiff from about 0.4 on.");
  d.attribute("density", &Tissue::density, "kg/m^3", density_range, "Density.");
  d.attribute("damping_mass", &Tissue::damping_mass, "1/s", between(0, 1e6),
              "Drag against the world, in proportion to mass.");
  d.attribute("damping_stiffness", &Tissue::damping_stiffness, "s", between(0, 1000),
              "Viscosity: time by which stress goes with the rate of strain.");
  d.attribute("element", &Tissue::element, {"unstated", "t4", "smoothed"},
              "Linear tets (t4), far too stiff in bending near poisson 0.5, or the same tets "
              "averaged over edges and nodes (smoothed), accurate there at three to four times the "
              "cost. Unstated: t4, the one that keeps pace with the clock, with a warning where it "
              "is too stiff.");
  d.attribute("iterations", &Tissue::iterations, between(1, 100),
              "Passes of the step, at least (docs/step.md); more follow where the tolerance asks "
              "for them.");
  d.attribute("velocity", &Tissue::velocity, "m/s", between(-1e4, 1e4), "Velocity at the start.");
  d.attribute("spin", &Tissue::spin, "rad/s", between(-1e6, 1e6),
              "Angular velocity at the start, about the centre of mass.");
  d.attribute("settle", &Tissue::settles,
              "Start at rest, in balance under weight and loads, instead of in the mesh's shape.");
  d.link("mesh", &Tissue::mesh, "Rest shape and regions.");
  d.link("solver", &Tissue::solver, "How the equations are solved; directly, if left out.")
      .optional();
  d.output("reaction", "N", "Force with which all attachments together hold the tissue.",
           [](const Tissue& t) -> Vec3 {
             Vec3 sum = Vec3::Zero();
             for (Index i = 0; i < t.dofs(); i += 3) sum += t.step_->reaction().segment<3>(i);
             return sum;
           });
  d.output("lowest", "m", "Height z of the lowest node.",
           [](const Tissue& t) -> Real { return lowest_node(t.positions()).z(); });
  d.output("max_displacement", "m", "Largest distance of a node from its rest position.",
           [](const Tissue& t) -> Real { return max_displacement(t.model_, t.positions()); });
  d.output("energy", "J", "Kinetic plus elastic energy.",
           [](const Tissue& t) -> Real { return t.energy(); });
  d.output("kinetic_energy", "J", "Kinetic energy.",
           [](const Tissue& t) { return t.kinetic_energy(); });
  d.output("elastic_energy", "J", "Elastic energy.",
           [](const Tissue& t) { return t.elastic_energy(); });
  d.output("momentum", "kg m/s", "Linear momentum.",
           [](const Tissue& t) -> Vec3 { return t.momentum(); });
  d.output("linearisations", "1", "Linearisations in the last step.",
           [](const Tissue& t) -> Real { return static_cast<Real>(t.step_->linearisations()); });
  d.output(
      "analyses", "1",
      "Times a step chose the order of elimination anew, because constraints touch other nodes.",
      [](const Tissue& t) -> Real { return static_cast<Real>(t.solve_report().analyses); });
  d.output("inverted", "1", "Tetrahedra turned inside out.",
           [](const Tissue& t) -> Real { return static_cast<Real>(t.inverted()); });
}

/// Things that are allowed, but seldom meant.
void Tissue::doubt(Setup& setup) const {
  doubt_material(*this, setup, {young, poisson, density});
  if (element == TissueElement::unstated && poisson > locking_poisson)
    setup.warning(*this, "poisson is " + format_real(poisson) + ", where " + too_stiff);
  const Real length = (mesh->report().high - mesh->report().low).maxCoeff();
  const bool doubted = !mesh->file.path.empty() && mesh->unit == TetMesh::Unit::unstated;
  if (length > longest_tissue && !doubted)
    setup.warning(*this, "the mesh is " + format_real(length) + " m long; is its unit right?");
  if (setup.scene == nullptr || setup.gravity.isZero() || may_be_held(*setup.scene)) return;
  setup.warning(*this, "nothing holds this tissue, it will fall; an <Attach> fixes a part of it");
}

/// Millimetres taken for centimetres pass for a plausible tissue by themselves, but not beside what
/// sews it.
void Tissue::doubt_size(Setup& setup) const {
  constexpr Real most_needles = 15, least_needles = 0.15;
  const Real length = (mesh->report().high - mesh->report().low).maxCoeff();
  if (setup.scene == nullptr || length > longest_tissue) return;
  for (const Component* c : setup.scene->components()) {
    const auto* curve = dynamic_cast<const CurveBody*>(c);
    if (curve == nullptr || !(curve->needle_length() > 0)) continue;
    const Real needles = length / curve->needle_length();
    if (needles < most_needles && needles > least_needles) continue;
    const auto mm = [](Real metres) { return format_real(std::round(1e5 * metres) / 100) + " mm"; };
    setup.warning(*this, "the mesh is " + mm(length) + " long and the needle of " + c->path() +
                             " " + mm(curve->needle_length()) +
                             "; is the unit of one of them wrong?");
    return;
  }
}

/// It is attached, or may lie on a tool or on a tissue that is held itself.
bool Tissue::may_be_held(const Scene& scene) const {
  std::set<const Component*> held;
  std::vector<std::vector<Component*>> contacts;
  for (const Component* c : scene.components()) {
    if (const auto* attach = dynamic_cast<const Attach*>(c)) held.insert(attach->tissue.get());
    if (c->info().name == "Tool") held.insert(c);
    if (c->info().name == "Contact") contacts.push_back(scene.links_of(*c));
  }
  const auto is_held = [&](const Component* c) { return held.contains(c); };
  for (std::size_t before = 0; before != held.size();) {
    before = held.size();
    for (const std::vector<Component*>& touching : contacts)
      if (std::any_of(touching.begin(), touching.end(), is_held))
        for (const Component* c : touching)
          if (dynamic_cast<const CurveBody*>(c) == nullptr) held.insert(c);
  }
  return is_held(this);
}

/// A Contact has nothing but it.
bool Tissue::touches_itself(const Scene& scene) const {
  const auto& all = scene.components();
  return std::any_of(all.begin(), all.end(), [&](const Component* c) {
    const std::vector<Component*>& links = scene.links_of(*c);
    return c->info().name == "Contact" && links.size() == 1 && links[0] == this;
  });
}

void Tissue::initialise(Setup& setup) {
  const MeshData& data = mesh->data();
  if (data.tets.size() > most_tets)
    return setup.error(*this, "mesh: " + std::to_string(data.tets.size()) +
                                  " tetrahedra are more than can be computed with; expected at "
                                  "most " +
                                  std::to_string(most_tets));
  doubt(setup);
  if (settles)
    setup.warn_without_effect(*this, {"velocity", "spin"}, "with 'settle' it begins at rest");
  const Index n = static_cast<Index>(data.points.size());
  model_.mesh = &data;
  model_.rest.resize(3 * n);
  for (Index i = 0; i < n; ++i) model_.rest.segment<3>(3 * i) = data.points[i];
  for (const Tet& t : data.tets)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b)
        model_.edge_length += (data.points[t[a]] - data.points[t[b]]).norm();
  model_.edge_length /= 6 * static_cast<Real>(data.tets.size());
  if (element == TissueElement::smoothed)
    model_.elastic = std::make_unique<SmoothedT4>(data.points, data.tets);
  else
    model_.elastic = std::make_unique<CorotationalT4>(data.points, data.tets);
  model_.held = HeldNodes(n);
  model_.damping_mass = damping_mass;
  model_.damping_stiffness = damping_stiffness;

  Cache* const cache = setup.resources.cache.get();
  own_solver_ = solver ? nullptr : make_direct_solver(setup.resources.cache);
  solver_ = solver ? solver.get() : own_solver_.get();
  step_.emplace(model_, *solver_, load(),
                cached(cache, PatternKey{mesh->shape(), element == TissueElement::smoothed}, [&] {
                  return std::make_shared<const NodePattern>(n, model_.elastic->pairs());
                }));
  update_materials();

  queries_.assign(3, SolidQueries(mesh->shape()->topology));
  for (SolidQueries& q : queries_) q.move(model_.rest);
}

/// Every Layer and Attach has spoken.
void Tissue::ready(Setup& setup) {
  doubt_size(setup);
  may_overlap_ = setup.scene == nullptr || !touches_itself(*setup.scene);
  step_->prepare(setup.dt);
  for (const SolidQueries& q : queries_) q.fit();
}

void Tissue::archive(Archive& a) {
  step_->archive(a);
  if (own_solver_) own_solver_->archive(a);
  overlap_.archive(a);
  if (a.restoring() && a.ok()) move_queries(Configuration::current, step_->positions());
}

void Tissue::set_state(const VecX& x, const VecX& v) {
  step_->set_state(x, v);
  move_queries(Configuration::current, step_->positions());
}

bool Tissue::set_material(int region, const Material& material) {
  if (!layers_.emplace(region, material).second) return false;
  update_materials();
  return true;
}

void Tissue::update_materials() {
  const MeshData& data = *model_.mesh;
  model_.mass.assign(data.points.size(), 0);
  model_.materials.clear();
  model_.young = 0;
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    const auto layer = layers_.find(data.region[e]);
    const Material material =
        layer != layers_.end() ? layer->second : Material{young, poisson, density};
    model_.materials.push_back(material);
    model_.young = std::max(model_.young, material.young);
    const Tet& t = data.tets[e];
    const Real volume =
        six_volume(data.points[t[0]], data.points[t[1]], data.points[t[2]], data.points[t[3]]) / 6;
    for (const Index i : t) model_.mass[i] += material.density * volume / 4;
  }
  model_.elastic->set_materials(model_.materials);
  start_moving();
}

/// Called again when a layer changes the masses, and with them their centre.
void Tissue::start_moving() {
  if (velocity.isZero(0) && spin.isZero(0)) return;
  const Vec3 centre = centre_of_mass();
  VecX v(dofs());
  for (Index i = 0; i < dofs(); i += 3)
    v.segment<3>(i) = velocity + spin.cross(model_.rest.segment<3>(i) - centre);
  step_->set_state(model_.rest, v);
}

Index Tissue::support(Index node, const std::array<bool, 3>& along) {
  return model_.held.support(node, along, model_.rest.segment<3>(3 * node),
                             1e6 * model_.young * model_.edge_length);
}

Vec3 Tissue::reaction(const std::vector<Index>& nodes) const {
  Vec3 sum = Vec3::Zero();
  for (const Index i : nodes)
    sum += step_->reaction().segment<3>(3 * i).cwiseQuotient(model_.held.holders(i).cwiseMax(1));
  return sum;
}

std::string Tissue::settle(const Vec3& gravity) {
  if (!model_.held.any())
    return "nothing holds this tissue, so it has no balance; it needs an Attach";
  VecX x = positions();
  if (load().size() != dofs()) load().setZero(dofs());
  std::string trouble = tissue::settle(model_, load(), gravity, x);
  if (!trouble.empty())
    if (const std::string free = free_motion(model_); !free.empty()) trouble += "; " + free;
  set_state(x, VecX::Zero(dofs()));
  step_->rest(gravity);
  step_->renew();
  return trouble;
}

void Tissue::begin_step(const StepContext& context) {
  step_->begin(context);
  move_queries(Configuration::start, step_->start_positions());
  move_queries(Configuration::current, step_->positions());
}

void Tissue::push(const StepContext& context, const VecX& force_change) {
  step_->push(context, force_change);
}

void Tissue::correct(const StepContext& context) {
  step_->correct(context);
  move_queries(Configuration::current, step_->positions());
}

void Tissue::motion(VecX& out) const {
  out = step_->positions() - step_->start_positions();
}

void Tissue::move_to(const StepContext& context, const VecX& motion) {
  step_->move_to(context, motion);
  move_queries(Configuration::current, step_->positions());
}

void Tissue::end_step(const StepContext& context, const VecX& force) {
  step_->end(context, force);
  if (may_overlap_)
    overlap_.look(queries(Configuration::current), model_.edge_length, context.time + context.dt);
}

std::string Tissue::fault() const {
  const Index n = inverted();
  if (n > 0)
    return std::to_string(n) + (n == 1 ? " tetrahedron is" : " tetrahedra are") +
           " turned inside out";
  constexpr Real too_much = 0.05;  // less is a dent, and what is around it bears it
  const Real collapsed = collapsed_share(model_, positions());
  if (collapsed < too_much) return {};
  return format_real(std::round(100 * collapsed)) +
         " % of the volume is compressed by more than (1 - 2 nu) / nu: it bears no shear there and "
         "may fold; take a smaller 'poisson'";
}

Vec3 Tissue::position(const EmbeddedPoint& p, Configuration c) const {
  return queries(c).position(p);
}

void Tissue::jacobian(const EmbeddedPoint& p, PointJacobian& out) const {
  const Tet& t = mesh->data().tets[p.element];
  out.width = 3;
  out.nodes = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (p.weights[k] != 0) ++out.nodes;  // a point of the surface has three nodes
  out.coefficients.setZero(3, 3 * out.nodes);
  int j = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (p.weights[k] == 0) continue;
    out.node[static_cast<std::size_t>(j)] = t[k];
    out.coefficients.block<3, 3>(0, 3 * j).diagonal().setConstant(p.weights[k]);
    ++j;
  }
}

std::optional<EmbeddedPoint> Tissue::locate(const Vec3& p, Configuration c) const {
  return queries(c).locate(p);
}
std::optional<SurfacePoint> Tissue::closest_surface(const Vec3& p, Real reach, Configuration c,
                                                    const Vec3& facing) const {
  return queries(c).closest_surface(p, reach, facing);
}
std::optional<SurfacePoint> Tissue::crossing(const Vec3& a, const Vec3& b, Configuration c,
                                             const Vec3& facing) const {
  return queries(c).crossing(a, b, facing);
}
Vec3 Tissue::surface_normal(Index triangle, Configuration c) const {
  return queries(c).surface_normal(triangle);
}
EmbeddedPoint Tissue::on_surface(Index triangle, const Vec3& weights) const {
  return queries(Configuration::rest).topology().on_surface(triangle, weights);
}
Elasticity Tissue::elasticity(const EmbeddedPoint& p) const {
  const Material& m = model_.materials[static_cast<std::size_t>(p.element)];
  return {m.young, m.poisson};
}

std::optional<int> Tissue::find_region(const std::string& name_or_tag, std::string& error) const {
  return mesh->region(name_or_tag, error);
}

int Tissue::region(const EmbeddedPoint& p) const {
  return mesh->data().region[p.element];
}

}  // namespace sutura::tissue
