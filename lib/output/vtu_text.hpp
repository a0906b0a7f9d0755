// Private header: a grid as the text of a file that VTK, ParaView, PyVista and meshio read.
#pragma once

#include <string>

#include "lib/output/frame_grid.hpp"

namespace apothem {

/// The grid as the text of a .vtu file, at a time in s. Data are base64 and zlib, which readers
/// other than VTK's accept as well, or text where there are none. A grid without cells has a
/// polygon without points, because meshio reads no file without cells; its whole numbers are -1 and
/// its other values 0. VTK's own writer takes five times as long.
std::string vtu_text(const FrameGrid& grid, double time);

}  // namespace apothem
