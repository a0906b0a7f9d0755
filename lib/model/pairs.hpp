// The contact law between any two bodies of a model.
#pragma once

#include "lib/contact/law/pair_table.hpp"
#include "lib/model/model.hpp"

namespace apothem {

inline PairTable pair_table(const Model& model) {
  std::vector<MaterialIndex> material;
  const auto bodies = static_cast<BodyIndex>(model.bodies.size() + model.deformables.size());
  for (BodyIndex i = 0; i < bodies; ++i) material.push_back(model.material_of(i));
  return {model.contact, material, static_cast<int>(model.materials.size())};
}

}  // namespace apothem
