#include "lib/model/model.hpp"

#include <algorithm>
#include <cmath>

#include "lib/model/rotation.hpp"

namespace apothem {

std::array<double, 3> RigidBody::inverse_mass() const {
  if (servo) {
    // d d^T/m for the direction d, or a matrix without other entries that is nowhere less.
    const double dx = std::abs(servo->direction.x()), dy = std::abs(servo->direction.y());
    return {dx * (dx + dy) / mass, dy * (dx + dy) / mass, 0};
  }
  if (motion != Motion::free) return {0, 0, 0};
  return {held[0] ? 0 : 1 / mass, held[1] ? 0 : 1 / mass, held[2] ? 0 : 1 / inertia};
}

std::vector<MaterialIndex> DeformableBody::materials() const {
  if (element_material.empty()) return {material};
  std::vector<MaterialIndex> all = element_material;
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

double RigidBody::reach() const {
  double reach = 0;
  for (const Vec2& v : potential.vertices) reach = std::max(reach, (v - pivot).norm());
  return reach;
}

const std::string& Model::name_of(BodyIndex body) const {
  const int rigid = static_cast<int>(bodies.size());
  return body < rigid ? bodies[body].name : deformables[body - rigid].name;
}

MaterialIndex Model::material_of(BodyIndex body) const {
  const int rigid = static_cast<int>(bodies.size());
  return body < rigid ? bodies[body].material : deformables[body - rigid].material;
}

int Model::node_count() const {
  if (deformables.empty()) return 0;
  return deformables.back().first_node + static_cast<int>(deformables.back().mesh.nodes.size());
}

Vec2 GravityPart::at(double time) const {
  const Vec2 now = history.at(time) * value;
  return tilt.points.empty() ? now : turned(now, -tilt.at(time));
}

Vec2 Model::gravity_at(double time) const {
  if (gravity_parts.empty()) return gravity_history.at(time) * gravity;
  Vec2 sum = Vec2::Zero();
  for (const GravityPart& part : gravity_parts) sum += part.at(time);
  return sum;
}

double Model::strongest_gravity() const {
  if (gravity_parts.empty()) return gravity.norm() * gravity_history.largest();
  double sum = 0;
  for (const GravityPart& part : gravity_parts) sum += part.value.norm() * part.history.largest();
  return sum;
}

void set_shape(RigidBody& body, const Polygon& polygon, const Model& model) {
  set_shape(body, polygon, make_potential(polygon, model.contact.potential), model);
}

void set_shape(RigidBody& body, const Polygon& polygon, Potential potential, const Model& model) {
  const AreaMoments moments = area_moments(polygon);
  body.potential = translated(std::move(potential), moments.centroid);
  body.inradius = polygon.is_convex() ? inscribed_circle(polygon).radius
                                      : body.potential.top / body.potential.steepest;
  body.area = moments.area;
  const double surface_density = model.materials[body.material].density * model.thickness;
  body.mass = surface_density * moments.area;
  body.inertia = surface_density * moments.polar;
  body.position = (polygon.origin() - model.origin) + moments.centroid;
}

}  // namespace apothem
