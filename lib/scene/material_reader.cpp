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
    if (const JsonValue* v = object.optional("young")) elastic.young = in_.positive(*v, "Pa");
    if (const JsonValue* v = object.optional("poisson")) {
      elastic.poisson = in_.number(*v, "");
      if (!(elastic.poisson > -1 && elastic.poisson < 0.5)) {
        in_.fail(*v, fmt::format("must lie between -1 and 0.5, not {}", elastic.poisson));
      }
    }
    if (const JsonValue* v = object.optional("plane")) {
      elastic.plane = static_cast<Plane>(in_.choice(*v, {kPlanes.begin(), kPlanes.end()}));
    }
    if (const JsonValue* v = object.optional("law")) {
      elastic.law =
          static_cast<ElasticLaw>(in_.choice(*v, {kElasticLaws.begin(), kElasticLaws.end()}));
    }
  }

  void damping(const JsonValue& value, Material& material) {
    features_.add(Feature::material_damping, &value);
    JsonObject object(in_, value);
    in_.choice(object.required("model", "\"rayleigh\""), {"rayleigh"});
    if (const JsonValue* v = object.optional("mass")) {
      material.mass_damping = in_.positive(*v, "1/s");
    }
    if (const JsonValue* v = object.optional("stiffness")) {
      material.stiffness_damping = in_.positive(*v, "s");
    }
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
