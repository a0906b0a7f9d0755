#include "apothem/dynamics/fold_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apothem/dynamics/contact_term.hpp"
#include "apothem/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kSkin = 0.5;  // of the shortest inradius: a look is cheap until then

}  // namespace

bool FoldWatch::needed(const Model& model) {
  return !model.deformables.empty() &&
         !(ContactTerm::touches_meshes(model) && model.contact.surface == ContactSurface::body);
}

FoldWatch::FoldWatch(const Model& model)
    : model_(model), outlines_(kSkin * shortest_inradius(model)) {
  for (const DeformableBody& body : model.deformables) {
    outlines_.add_mesh(body.mesh, boundary(body.mesh), body.first_node);
  }
}

void FoldWatch::watch(const State& state) {
  static const PlacedShapes kNoPolygons;
  try {
    outlines_.place(state.kinematics(state.v), kNoPolygons);
  } catch (const NotFinite&) {
    refuse_infinite(state, "a node");
  }
  if (outlines_.stale()) outlines_.prepare_search();
  if (const auto& self = outlines_.self_contact()) {
    refuse_fold(model_, state, static_cast<int>(model_.bodies.size()) + self->body, self->place);
  }
}

void refuse_fold(const Model& model, const State& state, BodyIndex body, const Vec2& place) {
  const Vec2 world = place + model.origin;
  throw Unstable(fmt::format(
      "\"{}\" folds onto itself at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {}): contact of a body "
      "with itself is not modelled; divide it into two bodies",
      model.name_of(body), world.x(), world.y(), state.time, state.step));
}

}  // namespace apothem
