#include "apothem/dynamics/fold_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apothem/dynamics/surface_contact.hpp"
#include "apothem/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kSkin = 0.5;  // of the shortest inradius: a look is cheap until then

double skin(const Model& model) {
  double shortest = HUGE_VAL;
  for (const DeformableBody& body : model.deformables) {
    shortest = std::min(shortest, boundary_inradius(body.mesh, boundary(body.mesh)));
  }
  return kSkin * shortest;
}

}  // namespace

bool FoldWatch::needed(const Model& model) {
  return !model.deformables.empty() &&
         !(SurfaceContact::needed(model) && model.contact.surface == ContactSurface::body);
}

FoldWatch::FoldWatch(const Model& model) : model_(model), outlines_(0, 1, skin(model), 1) {
  for (const DeformableBody& body : model.deformables) {
    outlines_.add_deformable(body.mesh, boundary(body.mesh), body.first_node);
  }
}

void FoldWatch::look(const State& state) {
  outlines_.update(state.displacement, {});
  if (const auto& self = outlines_.self_contact()) {
    const int rigid = static_cast<int>(model_.bodies.size());
    refuse_fold(model_, state, rigid + self->body, self->place);
  }
}

void refuse_fold(const Model& model, const State& state, int body, const Vec2& place) {
  const Vec2 world = place + model.origin;
  throw Unstable(fmt::format(
      "\"{}\" folds onto itself at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {}): contact of a body "
      "with itself is not modelled; divide it into two bodies",
      model.name_of(body), world.x(), world.y(), state.time, state.step));
}

}  // namespace apothem
