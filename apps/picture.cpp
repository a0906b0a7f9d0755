// apothem picture: a frame of a run, a strip of frames or a plot as PNG or SVG.

#include <fmt/format.h>

#include <cmath>

#include "apothem/output/files.hpp"
#include "apothem/output/run_picture.hpp"
#include "apothem/output/run_plot.hpp"
#include "commands.hpp"

namespace apothem {
namespace {

// Corners of a region in either order make a box.
std::optional<Box> box_of(const std::vector<double>& numbers) {
  if (numbers.empty()) return std::nullopt;
  Box box;
  box.include(numbers[0], numbers[1]);
  box.include(numbers[2], numbers[3]);
  if (!(box.x0 < box.x1 && box.y0 < box.y1 && std::isfinite(box.x1 - box.x0) &&
        std::isfinite(box.y1 - box.y0))) {
    throw UsageError("--window", "must be X0,Y0,X1,Y1 in m, of two opposite corners");
  }
  return box;
}

std::optional<Vec2> range_of(const std::vector<double>& numbers) {
  if (numbers.empty()) return std::nullopt;
  if (!(numbers[0] < numbers[1] && std::isfinite(numbers[1] - numbers[0]))) {
    throw UsageError("--range", "must be LOW,HIGH with LOW below HIGH");
  }
  return Vec2(numbers[0], numbers[1]);
}

std::string draw_frames(const PictureOptions& options, PictureFormat format) {
  const RunFolder run(options.folder);
  RunPicture picture;
  picture.frames =
      options.time ? std::vector<size_t>{run.nearest(*options.time)} : strip(run, options.strip);
  if (!options.colour.empty()) picture.quantity = field_quantity(options.colour);
  picture.chains = options.chains;
  picture.roses = options.roses;
  picture.deformation = options.deformation;
  picture.window = box_of(options.window);
  picture.range = range_of(options.range);
  return draw_fields(picture_of(run, picture), format);
}

std::string draw_plot(const PictureOptions& options, PictureFormat format) {
  std::optional<std::string> picture =
      draw_curves(plot_of(options.folder, options.plot, options.columns), format);
  if (picture) return std::move(*picture);
  throw UsageError("--plot",
                   "gnuplot draws plots, and it is not installed; on Debian: "
                   "apt-get install gnuplot-nox");
}

}  // namespace

int picture_command(const PictureOptions& options) {
  const std::string file = !options.output.empty()
                               ? options.output
                               : fmt::format("{}/{}.png", options.folder,
                                             options.plot.empty() ? "picture" : options.plot);
  const std::optional<PictureFormat> format = picture_format(file);
  if (!format) {
    throw UsageError("--output", fmt::format("must end in .png or .svg, not \"{}\"", file));
  }
  write_file(file,
             options.plot.empty() ? draw_frames(options, *format) : draw_plot(options, *format));
  fmt::print("{}\n", file);
  return exit_code::done;
}

}  // namespace apothem
