#include "apothem/run/hash.hpp"

#include "apothem/output/checksum.hpp"

namespace apothem {
namespace {

// Of values as they lie in memory.
class Hash : public Checksum {
 public:
  using Checksum::add;
  void add(std::span<const double> values) { add(values.data(), values.size_bytes()); }
  void add(const std::string& text) { add(text.data(), text.size() + 1); }
  void add(const Vec2& v) { add(v.data(), 2 * sizeof(double)); }
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
  }
  for (const DeformableBody& body : scene.model.deformables) {
    hash.add(body.name);
    hash.add(&body.material, sizeof body.material);
    for (const Vec2& v : body.mesh.nodes) hash.add(v);
    hash.add(body.element_material.data(), body.element_material.size() * sizeof(MaterialIndex));
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
