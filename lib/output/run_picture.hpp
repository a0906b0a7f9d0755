// Pictures of the results of a run: frames with the bodies in the colours of a quantity, with force
// chains and roses over them.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lib/output/field_picture.hpp"
#include "lib/output/run_folder.hpp"

namespace apothem {

/// What a picture of a run shows.
struct RunPicture {
  std::vector<size_t> frames;  ///< their numbers, from the left to the right
  /// Empty: the von Mises stress if there are bodies of finite elements; otherwise the material if
  /// chains are drawn, and the speed if not.
  const FieldQuantity* quantity = nullptr;
  bool chains = false;  ///< contact forces as lines, as wide as the forces
  bool roses = false;   ///< directions of the contacts in each region
  /// Factor of all displacements and rotations since the start of the run.
  double deformation = 1;
  std::optional<Box> window = {};  ///< visible region, m; empty: all bodies
  /// Ends of the colour scale, SI units; empty: all visible values.
  std::optional<Vec2> range = {};
};

/// So many frames of a run, at equal intervals of time from the first to the last one; all of them
/// if there are not so many, and the last one if `count` is 1.
std::vector<size_t> strip(const RunFolder& run, int count);

/// The picture. Calls on_frame(number of frames read so far) before it reads another one; what that
/// throws is passed on. Throws ResultsError if the run does not hold what is asked for.
FieldFigure picture_of(const RunFolder& run, const RunPicture& choice,
                       const std::function<void(size_t)>& on_frame = {});

}  // namespace apothem
