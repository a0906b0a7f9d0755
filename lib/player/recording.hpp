// Private header: a run as the arrays that the player shows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/output/field.hpp"
#include "lib/player/shapes.hpp"

namespace apothem {

/// The value of a body or element that has none, as the stress of a body that is not there.
inline constexpr float kNoValue = 3e38F;

/// A quantity over the run.
struct RecordedQuantity {
  const FieldQuantity* quantity = nullptr;
  std::string unit;                   ///< with a metric prefix, in which all numbers here are
  double low = 0, high = 1;           ///< ends of the colour scale
  bool below = false, above = false;  ///< whether there are values beyond these
  std::vector<float> values = {};     ///< of all bodies and then all elements, frame by frame
};

/// Force chains of all frames, one frame after the other.
struct RecordedChains {
  std::vector<std::int32_t> first{0};  ///< those of frame k are first[k] ... first[k + 1] - 1
  std::vector<std::int32_t> a, b;      ///< bodies
  std::vector<std::int32_t> ends;      ///< 1: leads to the centre of a; 2: of b; 3: of both
  std::vector<std::int32_t> near;      ///< 1 if the point is given from the centre of b, not of a
  std::vector<Vec2> point;             ///< loading point from that centre, m
  std::vector<double> force;           ///< size of the normal force, N
};

/// What the frames of a run hold. Bodies that are not there keep their last place.
struct Recording {
  std::vector<double> times;  ///< s
  std::vector<std::string> bodies, materials;
  Shapes shapes;
  /// Of each body, frame by frame: centroid in world coordinates (m), rotation since the body was
  /// defined (rad; 0 of meshed bodies), whether it is there.
  std::vector<Vec2> place;
  std::vector<double> rotation;
  std::vector<std::int32_t> present;
  std::vector<Vec2> nodes;  ///< of meshed bodies, frame by frame, m
  std::vector<RecordedQuantity> quantities;
  RecordedChains chains;

  /// Bodies, then elements of meshed bodies: what has values.
  [[nodiscard]] size_t items() const { return bodies.size() + shapes.elements.size(); }
};

/// Reads all frames. Throws ResultsError.
Recording record(const RunFolder& run);

}  // namespace apothem
