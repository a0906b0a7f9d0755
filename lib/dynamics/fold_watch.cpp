#include "lib/dynamics/fold_watch.hpp"

#include <fmt/format.h>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kSkin = 0.5;  // of the shortest inradius: a look is cheap until then

}  // namespace

bool FoldWatch::needed(const Model& model) {
  return !model.deformables.empty() && !ContactTerm::touches_itself(model);
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
  if (!outlines_.stale()) return;
  outlines_.prepare_search();
  for (size_t i = 0; i < outlines_.bodies.size(); ++i) {
    const std::optional<Vec2> place = crossing(outlines_.bodies[i]);
    if (!place) continue;
    const Vec2 world = *place + model_.origin;
    throw Unstable(fmt::format(
        "\"{}\" folds onto itself at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {}), and contact of a "
        "body with itself is not computed; say \"self_contact\": \"compute\" in \"contact\"",
        model_.name_of(static_cast<BodyIndex>(model_.bodies.size() + i)), world.x(), world.y(),
        state.time, state.step));
  }
}

// Where it has looked last: it looks again when nodes have moved far from there.
void FoldWatch::fields(Archive& archive) {
  std::vector<double> x = outlines_.searched_x(), y = outlines_.searched_y();
  archive("looked_at_x", x)("looked_at_y", y);
  if (!archive.loads()) return;
  if (x.size() != y.size()) throw ArchiveMismatch("looked_at_y");
  outlines_.forget();
  if (x.empty()) return;
  if (x.size() != static_cast<size_t>(outlines_.size())) throw ArchiveMismatch("looked_at_x");
  outlines_.prepare_search_at(x, y);
}

// Where edges of a body cross.
std::optional<Vec2> FoldWatch::crossing(const OutlineSurfaces::Body& body) {
  const OutlineSurfaces& o = outlines_;
  boxes_.assign(o.edge_boxes.begin() + body.first, o.edge_boxes.begin() + body.end);
  grid_.find_pairs(boxes_, pairs_);
  const auto side = [&](int e, int v) {
    return o.tx[e] * (o.y[v] - o.y[e]) - o.ty[e] * (o.x[v] - o.x[e]);
  };
  for (auto [i, j] : pairs_) {
    i += body.first, j += body.first;
    const int in = o.next[i], jn = o.next[j];
    if (i == jn || j == in) continue;
    const double p = side(i, j), q = side(i, jn);
    if (p * q < 0 && side(j, i) * side(j, in) < 0) {
      return o.point(j) + p / (p - q) * (o.point(jn) - o.point(j));
    }
  }
  return {};
}

}  // namespace apothem
