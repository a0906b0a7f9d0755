// Private header of the pictures of fields: where the parts of a panel stand.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "lib/output/field_picture.hpp"

namespace apothem {

// Lengths in points.
inline constexpr double kLabel = 22;  // height of the caption above a frame, of one line
inline constexpr double kPanelTitle = 34;
inline constexpr double kFrameLeft = 62;
inline constexpr double kColumnGap = 22, kRowGap = 8;
inline constexpr double kBelow = 40;     // numbers and name of x
inline constexpr double kNoteLine = 20;  // a line of explanation below
inline constexpr double kBarGap = 26, kBarWidth = 14, kBarHigh = 230;
inline constexpr double kCategory = 20;  // from line to line of a legend
inline constexpr size_t kMostCategories = 20;
inline constexpr double kTitleFont = 12, kLabelFont = 10.5, kNoteFont = 10;
inline constexpr double kNoteText = 38;  // from a sample of a line to the text beside it

/// Positions and scales of a panel. Lengths in points unless stated.
struct PanelLayout {
  Box window;              ///< visible region, m
  double low, high_value;  ///< ends of the colour scale
  bool values_below, values_above;
  std::set<size_t> categories;  ///< those that are visible, if the values are names
  int columns, rows;
  double wide, high;                ///< size of a frame
  double label;                     ///< height of the caption above a frame
  double right;                     ///< width of what stands on the right of the frames
  std::vector<std::string> ranges;  ///< of the values of each field, for its caption
  double largest_force;             ///< of the chains, N; 0: there are none
  double widest_chain;              ///< width of the line of that force
  std::vector<std::string> notes;   ///< on the lines over the bodies: of chains, then of roses

  [[nodiscard]] double frames_width() const { return columns * wide + (columns - 1) * kColumnGap; }
  [[nodiscard]] double width() const { return kFrameLeft + frames_width() + right; }
  [[nodiscard]] double frames_height() const {
    return rows * high + (rows - 1) * (label + kRowGap);
  }
  /// Of the frames and what stands beside them.
  [[nodiscard]] double middle_height() const {
    return std::max(frames_height(), kCategory * static_cast<double>(legend_lines()));
  }
  /// The last line may say that there are more categories.
  [[nodiscard]] size_t legend_lines() const { return std::min(categories.size(), kMostCategories); }
  [[nodiscard]] double height() const {
    return kPanelTitle + label + middle_height() + kBelow +
           kNoteLine * static_cast<double>(notes.size());
  }
};

/// Quantity and title of the panel.
std::string heading(const FieldPanel& panel);

/// Chooses the number of columns that makes the frames largest if `at_once` of the fields are drawn
/// together. `ruler` measures texts.
PanelLayout lay_out(const FieldPanel& panel, size_t at_once, const Canvas& ruler);

}  // namespace apothem
