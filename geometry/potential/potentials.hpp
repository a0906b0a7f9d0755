// The potentials of many polygons. The straight skeleton, which takes long to compute, is computed
// once for all polygons that are copies of each other (similar_shapes.hpp, skeletons.hpp).
#pragma once

#include <optional>
#include <vector>

#include "geometry/polygon/similar_shapes.hpp"
#include "geometry/potential/potential.hpp"
#include "geometry/skeleton/skeletons.hpp"

namespace apothem {

/// Makes the potentials of polygons, each as make_potential does. They depend on the order of the
/// polygons by round-off only: the first one of several copies is the original.
class Potentials {
 public:
  /// Computes the skeletons that the potentials share, with up to `processes` helper processes at
  /// the same time. The polygons must outlive this object. Polygons for which there is no potential
  /// cause no error yet.
  Potentials(std::vector<const Polygon*> polygons, const PotentialChoice& choice, int processes,
             const Progress& progress = {});

  /// The potential of a polygon. Throws InvalidPolygon as make_potential does. May be called by
  /// several threads at the same time.
  [[nodiscard]] Potential make(size_t polygon) const;

  /// A polygon whose first construction of a skeleton has failed, and the number of attempts.
  struct Repeated {
    size_t polygon;
    int attempts;
  };
  [[nodiscard]] std::vector<Repeated> repeated() const;

  /// Number of distinct polygons whose skeletons were constructed.
  [[nodiscard]] size_t distinct() const { return skeletons_.size(); }

 private:
  // The origin of a polygon's skeleton.
  struct Source {
    size_t skeleton;
    std::optional<Similarity> map;  // empty for an original
  };
  [[nodiscard]] Skeleton skeleton_of(size_t polygon) const;

  std::vector<const Polygon*> polygons_;
  PotentialChoice choice_;
  // Source of each polygon whose potential needs a skeleton.
  std::vector<std::optional<Source>> sources_;
  std::vector<SkeletonOrFailure> skeletons_;  // skeletons of the originals
};

}  // namespace apothem
