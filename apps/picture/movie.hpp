// Private header: a run as a movie.
#pragma once

#include "apps/commands.hpp"

namespace apothem {

/// Draws all frames as `apothem picture` does, with the same window and scales, and lets ffmpeg
/// (https://ffmpeg.org) make a movie of them. Throws UsageError if ffmpeg is not installed or the
/// file is neither .mp4 nor .gif, SystemFailure, ResultsError, and Interrupted after a signal.
void write_movie(const ViewOptions& options);

}  // namespace apothem
