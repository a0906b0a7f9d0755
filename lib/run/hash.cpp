#include "lib/run/hash.hpp"

#include <type_traits>

#include "lib/output/checksum.hpp"

namespace apothem {
namespace {

// Of values as they lie in memory.
class Hash : public Checksum {
 public:
  using Checksum::add;
  void add(std::span<const double> values) { add(values.data(), values.size_bytes()); }
  void add(const std::string& text) { add(text.data(), text.size() + 1); }
  template <class T>
  void add(const std::vector<T>& list) requires(std::is_trivially_copyable_v<T>) {
    const size_t size = list.size();
    add(&size, sizeof size);
    add(list.data(), size * sizeof(T));
  }
  void add(const std::vector<Vec2>& points) {
    for (const Vec2& v : points) add(v);
  }
  void add(const Vec2& v) { add(v.data(), 2 * sizeof(double)); }
  void add(double value) { add(&value, sizeof value); }
};

}  // namespace

std::string scene_hash(const Scene& scene) {
  Hash hash;
  hash.add(scene.text.data(), scene.text.size());
  for (const Setting& setting : scene.settings) {
    const std::string text = '\n' + setting.text();
    hash.add(text.data(), text.size());
  }
  // An imported drawing also gives names, and by its layers materials and motions.
  for (const RigidBody& body : scene.model.bodies) {
    hash.add(body.name);
    hash.add(&body.material, sizeof body.material);
    hash.add(&body.motion, sizeof body.motion);
    for (const Vec2& v : body.potential.vertices) hash.add(v);
    if (body.potential.links) hash.add(body.potential.links->starts);
  }
  for (const DeformableBody& body : scene.model.deformables) {
    hash.add(body.name);
    hash.add(&body.material, sizeof body.material);
    for (const Vec2& v : body.mesh.nodes) hash.add(v);
    hash.add(body.element_material.data(), body.element_material.size() * sizeof(MaterialIndex));
  }
  return hash.text();
}

std::string potentials_hash(const Model& model) {
  Hash hash;
  for (const RigidBody& body : model.bodies) {
    const Potential& p = body.potential;
    hash.add(p.vertices), hash.add(p.gradients), hash.add(p.top_points);
    hash.add(p.top), hash.add(p.steepest);
    if (p.links) hash.add(p.links->starts);
    if (p.roof) {
      hash.add(p.roof->points), hash.add(p.roof->values), hash.add(p.roof->arcs);
      for (const std::vector<int>& face : p.roof->faces) hash.add(face);
    }
    if (p.distance) hash.add(p.distance->slope), hash.add(p.distance->corners);
    if (p.layer) hash.add(p.layer->depth), hash.add(p.layer->side);
  }
  return hash.text();
}

std::string text_hash(std::string_view text) {
  Hash hash;
  hash.add(text.data(), text.size());
  return hash.text();
}

std::string state_hash(const State& state) {
  Hash hash;
  hash.add(&state.time, sizeof state.time);
  for (const std::vector<double>* v : {&state.x, &state.v, &state.f}) {
    hash.add(state.layout.of_rigid(*v));
  }
  for (const std::vector<double>* v : {&state.x, &state.v, &state.f}) {
    hash.add(state.layout.of_nodes(*v));
  }
  return hash.text();
}

}  // namespace apothem
