#include "geometry/potential/potentials.hpp"

namespace apothem {

Potentials::Potentials(std::vector<const Polygon*> polygons, const PotentialChoice& choice,
                       int processes, const Progress& progress)
    : polygons_(std::move(polygons)), choice_(choice), sources_(polygons_.size()) {
  if (!needs_skeleton(choice_)) return;
  SimilarShapes shapes;
  std::vector<size_t> number;  // skeleton of each polygon that was added to the shapes
  std::vector<const Polygon*> originals;
  for (size_t i = 0; i < polygons_.size(); ++i) {
    if (polygons_[i]->is_convex()) continue;
    if (const auto copied = shapes.add(*polygons_[i])) {
      number.push_back(number[static_cast<size_t>(copied->index)]);
      sources_[i] = Source{number.back(), copied->map};
      continue;
    }
    number.push_back(originals.size());
    sources_[i] = Source{number.back(), std::nullopt};
    originals.push_back(polygons_[i]);
  }
  skeletons_ = straight_skeletons(originals, processes, progress);
}

Skeleton Potentials::skeleton_of(size_t polygon) const {
  const Source& source = *sources_[polygon];
  const SkeletonOrFailure& original = skeletons_[source.skeleton];
  if (const auto* failure = std::get_if<std::exception_ptr>(&original)) {
    std::rethrow_exception(*failure);
  }
  const auto& skeleton = std::get<Skeleton>(original);
  if (!source.map) return skeleton;
  if (auto copy = copied_skeleton(skeleton, *source.map, *polygons_[polygon])) {
    return std::move(*copy);
  }
  return straight_skeleton(*polygons_[polygon]);
}

std::vector<Potentials::Repeated> Potentials::repeated() const {
  std::vector<Repeated> list;
  for (size_t i = 0; i < sources_.size(); ++i) {
    if (!sources_[i] || sources_[i]->map) continue;
    const auto* skeleton = std::get_if<Skeleton>(&skeletons_[sources_[i]->skeleton]);
    if (skeleton && skeleton->attempts > 1) list.push_back({i, skeleton->attempts});
  }
  return list;
}

Potential Potentials::make(size_t polygon) const {
  if (!sources_[polygon]) return make_potential(*polygons_[polygon], choice_);
  return make_potential(*polygons_[polygon], choice_,
                        [this, polygon] { return skeleton_of(polygon); });
}

}  // namespace apothem
