#include "tissue.h"

#include "attach.h"
#include "corotational_t4.h"
#include "direct_solver.h"
#include "material_limits.h"
#include "smoothed_t4.h"
#include "sutura/archive.h"
#include "sutura/scene.h"

namespace sutura {
namespace {

constexpr std::size_t most_tets = 1000000;  // some 4 GB with matrix and factor

}  // namespace

void Tissue::describe(Describe<Tissue>& d) {
  d.summary("Soft tissue: corotational tetrahedra, lumped mass, implicit Euler.");
  d.attribute("young", &Tissue::young, "Pa", young_range,
              "Young modulus, where no Layer says otherwise.");
  d.attribute("poisson", &Tissue::poisson, "1", strictly_between(-1, 0.5),
              "Poisson ratio; linear elements grow too stiff from about 0.4 on.");
  d.attribute("density", &Tissue::density, "kg/m^3", density_range, "Density.");
  d.attribute("damping_mass", &Tissue::damping_mass, "1/s", between(0, 1e6),
              "Rayleigh damping in proportion to mass: a drag against the world.");
  d.attribute("damping_stiffness", &Tissue::damping_stiffness, "s", between(0, 1000),
              "Rayleigh damping in proportion to stiffness: viscosity.");
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
             for (Index i = 0; i < t.dofs(); i += 3) sum += t.reaction_.segment<3>(i);
             return sum;
           });
  d.output("lowest", "m", "Height z of the lowest node.",
           [](const Tissue& t) -> Real { return t.lowest().z(); });
  d.output("max_displacement", "m", "Largest distance of a node from its rest position.",
           [](const Tissue& t) -> Real { return t.max_displacement(); });
  d.output("energy", "J", "Kinetic plus elastic energy.",
           [](const Tissue& t) -> Real { return t.energy(); });
  d.output("kinetic_energy", "J", "Kinetic energy.",
           [](const Tissue& t) { return t.kinetic_energy(); });
  d.output("elastic_energy", "J", "Elastic energy.",
           [](const Tissue& t) { return t.elastic_energy(); });
  d.output("momentum", "kg m/s", "Linear momentum.",
           [](const Tissue& t) -> Vec3 { return t.momentum(); });
  d.output("linearisations", "1", "Linearisations in the last step.",
           [](const Tissue& t) -> Real { return static_cast<Real>(t.linearisations_); });
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
  constexpr Real longest = 5;  // m
  const Real length = (mesh->report().high - mesh->report().low).maxCoeff();
  const bool doubted = !mesh->file.path.empty() && mesh->unit == TetMesh::Unit::unstated;
  if (length > longest && !doubted)
    setup.warning(*this, "the mesh is " + format_real(length) + " m long; is its unit right?");
  if (setup.scene == nullptr || setup.gravity.isZero()) return;
  for (const Component* other : setup.scene->components()) {
    const auto* attach = dynamic_cast<const Attach*>(other);
    if (attach != nullptr && attach->tissue.get() == this) return;
  }
  setup.warning(*this, "nothing holds this tissue, it will fall; an <Attach> fixes a part of it");
}

void Tissue::initialise(Setup& setup) {
  const MeshData& data = mesh->data();
  if (data.tets.size() > most_tets)
    return setup.error(*this, "mesh: " + std::to_string(data.tets.size()) +
                                  " tetrahedra are more than can be computed with; expected at "
                                  "most " +
                                  std::to_string(most_tets));
  doubt(setup);
  const Index n = static_cast<Index>(data.points.size());
  rest_.resize(3 * n);
  for (Index i = 0; i < n; ++i) rest_.segment<3>(3 * i) = data.points[i];
  x_ = start_x_ = linearised_at_ = rest_;
  v_ = start_v_ = change_ = elastic_force_ = missing_ = reaction_ = VecX::Zero(3 * n);
  fixed_.assign(data.points.size(), 0);
  for (const Tet& t : data.tets)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) edge_length_ += (data.points[t[a]] - data.points[t[b]]).norm();
  edge_length_ /= 6 * static_cast<Real>(data.tets.size());

  if (element == TissueElement::smoothed)
    elastic_ = std::make_unique<SmoothedT4>(data.points, data.tets);
  else
    elastic_ = std::make_unique<CorotationalT4>(data.points, data.tets);
  A_ = std::make_unique<NodeMatrix>(n, elastic_->pairs());
  elastic_->bind(*A_->pattern());
  update_materials();

  const auto topology =
      std::make_shared<const SolidTopology>(data.points, data.tets, mesh->boundary());
  queries_.assign(3, SolidQueries(topology));
  for (SolidQueries& q : queries_) q.move(rest_);

  own_solver_ = solver ? nullptr : make_direct_solver();
  solver_ = solver ? solver.get() : own_solver_.get();
}

/// Every Layer and Attach has spoken. The factor that the first step needs is made here: the first
/// step finds the same matrix again.
void Tissue::ready(Setup& setup) {
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (fixed_[i]) v_.segment<3>(3 * static_cast<Index>(i)).setZero();
  solver_->analyse(A_->pattern(), fixed_, {});
  assemble({.dt = setup.dt, .gravity = setup.gravity});
}

void Tissue::archive(Archive& a) {
  const Index size = dofs();
  a("positions", x_);
  a("velocities", v_);
  a("reaction", reaction_);
  a("linearisations", linearisations_);
  a("assembled_for", assembled_for_);  // another length of step renews the factor
  a("at_work", at_work_);              // how well the first pass has to be solved
  if (own_solver_) own_solver_->archive(a);
  if (!a.restoring() || !a.ok()) return;
  if (x_.size() != size || v_.size() != size || reaction_.size() != size)
    return a.fail("the state of another mesh");
  set_state(x_, v_);
}

bool Tissue::set_material(int region, const Material& material) {
  if (!materials_.emplace(region, material).second) return false;
  update_materials();
  return true;
}

void Tissue::update_materials() {
  const MeshData& data = mesh->data();
  mass_.assign(data.points.size(), 0);
  tet_material_.clear();
  for (std::size_t e = 0; e < data.tets.size(); ++e) {
    const auto layer = materials_.find(data.region[e]);
    const Material material =
        layer != materials_.end() ? layer->second : Material{young, poisson, density};
    tet_material_.push_back(material);
    const Tet& t = data.tets[e];
    const Real volume =
        six_volume(data.points[t[0]], data.points[t[1]], data.points[t[2]], data.points[t[3]]) / 6;
    for (const Index i : t) mass_[i] += material.density * volume / 4;
  }
  elastic_->set_materials(tet_material_);
  start_moving();
}

void Tissue::fix(const std::vector<Index>& nodes) {
  for (const Index i : nodes) fixed_[i] = 1;
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
  const Material& m = tet_material_[static_cast<std::size_t>(p.element)];
  return {m.young, m.poisson};
}

std::optional<int> Tissue::find_region(const std::string& name_or_tag, std::string& error) const {
  return mesh->region(name_or_tag, error);
}

int Tissue::region(const EmbeddedPoint& p) const {
  return mesh->data().region[p.element];
}

}  // namespace sutura
