#include "lib/scene/material_reader.hpp"

#include <fmt/format.h>

namespace apothem {
namespace {

class MaterialReader {
 public:
  MaterialReader(const JsonReader& in, UsedFeatures& features) : in_(in), features_(features) {}

  Material read(const std::string& name, const JsonValue& value) {
    JsonObject object(in_, value);
    Material material{name, in_.positive(object.required("density", "in kg/m^3"), "kg/m^3")};
    // Only bodies with a mesh use the elastic constants, but wrong ones are refused in any case.
    elastic(object, material.elastic);
    if (const JsonValue* v = object.optional("damping")) damping(*v, material);
    object.finish();
    return material;
  }

 private:
  void elastic(JsonObject& object, Elastic& elastic) {
    object.read("young", elastic.young, &JsonReader::positive, "Pa");
    if (const JsonValue* v = object.optional("poisson")) {
      elastic.poisson = in_.number(*v, "");
      if (!(elastic.poisson > -1 && elastic.poisson < 0.5)) {
        in_.fail(*v, fmt::format("must lie between -1 and 0.5, not {}", elastic.poisson));
      }
    }
    object.choose("plane", elastic.plane, kPlanes);
    object.choose("law", elastic.law, kElasticLaws);
  }

  void damping(const JsonValue& value, Material& material) {
    features_.add(Feature::material_damping, &value);
    JsonObject object(in_, value);
    in_.choice(object.required("model", "\"rayleigh\""), {"rayleigh"});
    object.read("mass", material.mass_damping, &JsonReader::positive, "1/s");
    object.read("stiffness", material.stiffness_damping, &JsonReader::positive, "s");
    object.finish();
    if (material.mass_damping == 0 && material.stiffness_damping == 0) {
      in_.fail(value, "must give \"mass\" (alpha in 1/s), \"stiffness\" (beta in s) or both");
    }
  }

  const JsonReader& in_;
  UsedFeatures& features_;
};

}  // namespace

std::vector<Material> read_materials(const JsonReader& in, const JsonValue& value,
                                     UsedFeatures& features) {
  JsonObject object(in, value);
  std::vector<Material> materials;
  for (size_t i = 0; i < value.keys().size(); ++i) {
    materials.push_back(MaterialReader(in, features).read(value.keys()[i], value.items()[i]));
  }
  if (materials.empty()) in.fail(value, "must hold at least one material");
  return materials;
}

}  // namespace apothem
