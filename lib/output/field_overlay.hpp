// Private header of the pictures of fields: the lines over the colours of bodies.
#pragma once

#include <vector>

#include "lib/output/axes.hpp"
#include "lib/output/canvas.hpp"
#include "lib/output/field.hpp"

namespace apothem {

/// The boundaries of all bodies; `area` of the frame (square points) and the number of bodies say
/// how fine the lines are.
void draw_outlines(Canvas& canvas, const Axes& axes, const Field& field, double area);

/// Force chains: lines as wide as the normal force; that of `largest` (N) is `widest` points wide.
void draw_chains(Canvas& canvas, const Axes& axes, const std::vector<ForceChain>& chains,
                 double largest, double widest);

/// Rose diagrams, each with the circle that it would be if no direction were preferred.
void draw_roses(Canvas& canvas, const Axes& axes, const std::vector<Rose>& roses);

/// Samples of the lines: of the widest chain, and of a rose. `at`: middle of the left end.
void draw_chain_sample(Canvas& canvas, const Vec2& at, double widest);
void draw_rose_sample(Canvas& canvas, const Vec2& at);

}  // namespace apothem
