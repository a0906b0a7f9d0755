#include "geometry/polygon/canonical_pose.hpp"

#include <algorithm>
#include <array>

#include "geometry/polygon/predicates.hpp"

namespace apothem {
namespace {

// Each of the three steps in which points are made symmetric halves a sum.
constexpr int kHalvings = 3;

bool ring_precedes(const std::vector<Vec2>& p, const std::vector<Vec2>& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(), precedes);
}

Rings image(const Polygon& polygon, const AxisMap& map) {
  Rings rings = rings_of(polygon);
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v = map(v);
    if (map.mirrors()) std::reverse(ring.begin(), ring.end());
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), precedes), ring.end());
  }
  std::sort(rings.begin() + 1, rings.end(), ring_precedes);
  return rings;
}

// The map that does what the first one does after the second one has been undone.
AxisMap composed(const AxisMap& first, const AxisMap& second) {
  const Vec2 x = first(second.undo({1, 0})), y = first(second.undo({0, 1}));
  const Vec2 sum = x + y;
  return {x.x() == 0, sum.x(), sum.y()};
}

bool rings_precede(const Rings& p, const Rings& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(), ring_precedes);
}

}  // namespace

FirstImage first_image(const std::vector<const Polygon*>& polygons) {
  FirstImage first;
  for (const bool exchanged : {false, true}) {
    for (const double x : {1., -1.}) {
      for (const double y : {1., -1.}) {
        const AxisMap map{exchanged, x, y};
        std::vector<Rings> images;
        images.reserve(polygons.size());
        for (const Polygon* polygon : polygons) images.push_back(image(*polygon, map));
        const bool none = first.maps.empty();
        if (!none && images == first.polygons) {
          first.maps.push_back(map);
        } else if (none || std::lexicographical_compare(images.begin(), images.end(),
                                                        first.polygons.begin(),
                                                        first.polygons.end(), rings_precede)) {
          first = {std::move(images), {map}};
        }
      }
    }
  }
  return first;
}

CanonicalPose::CanonicalPose(const Polygon& polygon)
    : polygon_([&] {
        const FirstImage images = first_image({&polygon});
        map_ = images.maps.front();
        // A half turn, a quarter turn and a mirror, in this order, make all symmetries there are.
        std::array<const AxisMap*, kHalvings> steps{};
        for (const AxisMap& image : images.maps) {
          const AxisMap symmetry = composed(image, map_);
          const bool half = !symmetry.exchanged && symmetry.x < 0 && symmetry.y < 0;
          const bool same = !symmetry.exchanged && symmetry.x > 0 && symmetry.y > 0;
          if (!same) steps[symmetry.mirrors() ? 2 : half ? 0 : 1] = &image;
        }
        for (const AxisMap* image : steps) {
          if (image) symmetries_.push_back(composed(*image, map_));
        }
        return Polygon(polygon_of_rings(images.polygons.front()));
      }()),
      grid_(polygon_),
      given_(polygon.origin()),
      given_anchor_(PlaceGrid(polygon).anchor()) {}

std::vector<Vec2> CanonicalPose::back(std::vector<Vec2> points) const {
  // Places are counted from the anchors of the origins: between anchors, and between their images,
  // all differences are exact, which those between vertices are not.
  const Vec2 anchor = grid_.anchor();
  const int digits = symmetries_.empty() ? PlaceGrid::kDigits : PlaceGrid::kDigits - kHalvings;
  for (Vec2& p : points) p = grid_.rounded(p + (polygon_.origin() - anchor), digits);
  for (const AxisMap& symmetry : symmetries_) {
    const Vec2 shift = symmetry(anchor) - anchor;
    std::vector<Vec2> images;
    images.reserve(points.size());
    for (const Vec2& p : points) images.emplace_back(symmetry(p) + shift);
    for (Vec2& p : points) {
      p = (p + *std::min_element(images.begin(), images.end(),
                                 [&](const Vec2& a, const Vec2& b) {
                                   return (a - p).squaredNorm() < (b - p).squaredNorm();
                                 })) /
          2;
    }
  }
  const Vec2 shift = map_.undo(anchor) - given_anchor_;
  for (Vec2& p : points) p = (map_.undo(p) + shift) - (given_ - given_anchor_);
  return points;
}

}  // namespace apothem
