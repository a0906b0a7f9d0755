// How the frames of a run are written.
#pragma once

#include <array>

namespace apothem {

/// Files of their own in VTK's format, or all in one container: HDF5 with a description in XDMF.
enum class FrameFormat { vtu, xdmf };
/// By the names in scenes, in the order of FrameFormat.
inline constexpr std::array kFrameFormats{"vtu", "xdmf"};

}  // namespace apothem
