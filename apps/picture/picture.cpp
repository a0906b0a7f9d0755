// apothem picture: a frame of a run, a strip of frames or a plot as PNG or SVG.

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "apps/picture/extent.hpp"
#include "lib/output/files.hpp"
#include "lib/output/run_picture.hpp"
#include "lib/output/run_plot.hpp"

namespace apothem {
namespace {

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
