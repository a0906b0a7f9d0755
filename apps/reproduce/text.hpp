// Private header: what a figure says in words.
#pragma once

#include "lib/output/report.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Reads the keys "about", "paper", "open" and "verdict" of a figure. Throws SceneError.
FigureText read_figure_text(const JsonReader& in, JsonObject& figure);

}  // namespace apothem
