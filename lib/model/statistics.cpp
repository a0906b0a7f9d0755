#include "lib/model/statistics.hpp"

#include <algorithm>

#include "geometry/polygon/ring_moments.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/rotation.hpp"

namespace apothem {
namespace {

BodyIndex body_count(const Model& model) {
  return static_cast<BodyIndex>(model.bodies.size() + model.deformables.size());
}

bool is_rigid(const Model& model, BodyIndex body) {
  return body < static_cast<BodyIndex>(model.bodies.size());
}

const DeformableBody& meshed(const Model& model, BodyIndex body) {
  return model.deformables[body - static_cast<BodyIndex>(model.bodies.size())];
}

std::vector<Vec2> corners_of(const Model& model, const State& state, BodyIndex body,
                             std::span<const int> element) {
  const DeformableBody& of = meshed(model, body);
  std::vector<Vec2> ring;
  for (const int node : element) {
    ring.push_back(of.mesh.nodes[node] + state.node(of.first_node + node));
  }
  return ring;
}

// Mean stress of a mesh, and its area.
std::pair<CauchyStress, double> mean_stress(const Model& model, const State& state, BodyIndex body,
                                            const CauchyStress* stress) {
  const Mesh& mesh = meshed(model, body).mesh;
  CauchyStress sum;
  double whole = 0;
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    const double area = ring_area(corners_of(model, state, body, mesh.element(e)));
    whole += area;
    sum.xx += area * stress[e].xx;
    sum.yy += area * stress[e].yy;
    sum.xy += area * stress[e].xy;
    sum.zz += area * stress[e].zz;
  }
  return {{sum.xx / whole, sum.yy / whole, sum.xy / whole, sum.zz / whole, 0}, whole};
}

// Mass, place, momentum and kinetic energy of a body.
struct Motions {
  double mass = 0;
  Vec2 place = Vec2::Zero(), momentum = Vec2::Zero();
  double translation = 0, rotation = 0;
};
Motions motions_of(const Model& model, const State& state, const std::vector<double>& node_mass,
                   BodyIndex body) {
  Motions m;
  if (is_rigid(model, body)) {
    const RigidBody& of = model.bodies[body];
    const auto x = state.pose(body), v = state.pose_rate(body);
    m.mass = of.mass;
    m.place = x.head<2>();
    m.momentum = of.mass * v.head<2>();
    m.translation = of.mass * v.head<2>().squaredNorm() / 2;
    m.rotation = of.inertia * v[2] * v[2] / 2;
    return m;
  }
  const DeformableBody& of = meshed(model, body);
  for (int i = 0; i < static_cast<int>(of.mesh.nodes.size()); ++i) {
    const double mass = node_mass[static_cast<size_t>(of.first_node) + static_cast<size_t>(i)];
    const Vec2 v = state.node_velocity(of.first_node + i);
    m.mass += mass;
    m.place += mass * (of.mesh.nodes[i] + state.node(of.first_node + i));
    m.momentum += mass * v;
    m.translation += mass * v.squaredNorm() / 2;
  }
  m.place /= m.mass;
  return m;
}

double area_in(const Model& model, const State& state, BodyIndex body, const Region& region) {
  if (is_rigid(model, body)) {
    const auto x = state.pose(body);
    double sum = 0;  // holes are clockwise, so that their areas count as negative
    for (std::vector<Vec2>& ring : model.bodies[body].rings()) {
      for (Vec2& v : ring) v = Vec2(x.head<2>()) + turned(v, x[2]);
      sum += region.overlap(ring);
    }
    return sum;
  }
  const Mesh& mesh = meshed(model, body).mesh;
  double sum = 0;
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    sum += region.overlap(corners_of(model, state, body, mesh.element(e)));
  }
  return sum;
}

// Of the material without deformation, m^3.
double volume_of(const Model& model, BodyIndex body) {
  if (is_rigid(model, body)) return model.bodies[body].area * model.thickness;
  const Mesh& mesh = meshed(model, body).mesh;
  double area = 0;
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) area += element_area(mesh, e);
  return area * model.thickness;
}

}  // namespace

bool is_free(const Model& model, BodyIndex body) {
  if (is_rigid(model, body)) {
    const RigidBody& of = model.bodies[body];
    return of.motion == Motion::free && !(of.held[0] && of.held[1]);
  }
  bool held_x = false, held_y = false;
  for (const Support& support : meshed(model, body).supports) {
    const bool moved = !support.motion.empty();
    held_x = held_x || support.held[0] || moved;
    held_y = held_y || support.held[1] || moved;
  }
  return !(held_x && held_y);
}

std::vector<BodyStatistics> body_statistics(const Model& model, const State& state,
                                            const std::vector<ContactRecord>& contacts,
                                            const std::vector<CauchyStress>& stresses) {
  const BodyIndex count = body_count(model);
  std::vector<BodyStatistics> result(static_cast<size_t>(count));
  std::vector<std::pair<BodyIndex, BodyIndex>> touching;
  for (const ContactRecord& c : contacts) {
    if (c.a == c.b) continue;
    touching.emplace_back(c.a, c.b);
    const Vec2 on_a = c.normal + c.damping + c.tangential;
    for (const BodyIndex body : {c.a, c.b}) {
      if (!is_rigid(model, body)) continue;
      const Vec2 force = body == c.a ? on_a : Vec2(-on_a);
      const Vec2 arm = c.point - Vec2(state.pose(body).head<2>());
      const double volume = model.bodies[body].area * model.thickness;
      CauchyStress& s = result[static_cast<size_t>(body)].stress;
      s.xx += force.x() * arm.x() / volume;
      s.yy += force.y() * arm.y() / volume;
      s.xy += (force.x() * arm.y() + force.y() * arm.x()) / 2 / volume;
    }
  }
  std::ranges::sort(touching);
  touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
  for (const auto& [a, b] : touching) {
    ++result[static_cast<size_t>(a)].coordination;
    ++result[static_cast<size_t>(b)].coordination;
  }
  const CauchyStress* stress = stresses.data();
  for (BodyIndex b = static_cast<BodyIndex>(model.bodies.size()); b < count; ++b) {
    result[static_cast<size_t>(b)].stress = mean_stress(model, state, b, stress).first;
    stress += meshed(model, b).mesh.element_count();
  }
  return result;
}

std::vector<RegionSums> region_sums(const Model& model, const State& state,
                                    const std::vector<double>& node_mass,
                                    const std::vector<ContactRecord>& contacts,
                                    const std::vector<BodyStatistics>& bodies, bool statics) {
  std::vector<RegionSums> result;
  for (const Region& region : model.regions) {
    RegionSums& sums = result.emplace_back();
    sums.area = region.area;
    sums.volume = region.area * model.thickness;
    for (BodyIndex b = 0; b < body_count(model); ++b) {
      if (state.is_absent(b)) continue;
      const double solid = area_in(model, state, b, region);
      sums.solid_area += solid;
      const bool free = is_free(model, b);
      if (!free && (!statics || is_rigid(model, b))) continue;
      const Motions m = motions_of(model, state, node_mass, b);
      if (!region.contains(m.place)) continue;
      const BodyStatistics& own = bodies[static_cast<size_t>(b)];
      const double volume = volume_of(model, b);
      sums.stress.xx += volume * own.stress.xx;
      sums.stress.yy += volume * own.stress.yy;
      sums.stress.xy += volume * own.stress.xy;
      if (!free) continue;
      ++sums.count;
      sums.mass += m.mass;
      sums.momentum += m.momentum;
      sums.translation += m.translation;
      sums.rotation += m.rotation;
      sums.coordination += own.coordination;
    }
    for (const ContactRecord& c : contacts) {
      if (!region.contains(c.point) || (!is_free(model, c.a) && !is_free(model, c.b))) continue;
      const double force = c.normal.norm();
      if (!(force > 0)) continue;
      const Vec2 n = c.normal / force;
      ++sums.contacts;
      sums.fabric.xx += n.x() * n.x();
      sums.fabric.yy += n.y() * n.y();
      sums.fabric.xy += n.x() * n.y();
      sums.force += force;
      sums.force_2 += force * force;
      sums.largest_force = std::max(sums.largest_force, force);
    }
  }
  return result;
}

Crowd crowd_in(const Model& model, const State& state, const std::vector<double>& node_mass,
               int region) {
  Crowd crowd;
  for (BodyIndex b = 0; b < body_count(model); ++b) {
    if (state.is_absent(b) || !is_free(model, b)) continue;
    const Motions m = motions_of(model, state, node_mass, b);
    if (region >= 0 && !model.regions[static_cast<size_t>(region)].contains(m.place)) continue;
    crowd.members.push_back(b);
    crowd.kinetic += m.translation + m.rotation;
  }
  return crowd;
}

}  // namespace apothem
