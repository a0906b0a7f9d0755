#include "apps/picture/movie.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <numeric>

#include "apps/picture/extent.hpp"
#include "apps/process/child_program.hpp"
#include "apps/process/work_line.hpp"
#include "lib/output/files.hpp"
#include "lib/output/run_picture.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;

// The shell's exit code for a program that is not there, which env(1) has too.
constexpr int kNotFound = 127;

ProgramResult ffmpeg(std::vector<std::string> words) {
  words.insert(words.begin(), {"/usr/bin/env", "ffmpeg", "-loglevel", "error"});
  return run_program(words);
}

void require_ffmpeg() {
  const ProgramResult result = ffmpeg({"-version"});
  if (result.start_error == 0 && result.code == 0) return;
  throw UsageError("--movie",
                   result.code == kNotFound || result.start_error != 0
                       ? "ffmpeg makes movies, and it is not installed; on Debian: "
                         "apt-get install ffmpeg. A page to play needs no other program: "
                         "leave out --movie"
                       : "ffmpeg does not work: " + result.err);
}

// Movies that most programs play need an even width and height, and colours of half the resolution;
// GIF has 256 colours, which are chosen for the whole movie.
std::vector<std::string> format_of(const std::string& file) {
  if (file.ends_with(".mp4")) {
    return {"-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
            "-c:v",      "libx264",
            "-pix_fmt",  "yuv420p",
            "-movflags", "+faststart"};
  }
  if (file.ends_with(".gif")) {
    return {"-vf", "split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse=dither=none"};
  }
  throw UsageError("--movie", fmt::format("must end in .mp4 or .gif, not \"{}\"", file));
}

}  // namespace

void write_movie(const ViewOptions& options) {
  const std::vector<std::string> format = format_of(options.movie);
  const RunFolder run(options.folder);
  require_ffmpeg();
  WorkLine line(fmt::format("{} frames", run.times().size()));
  RunPicture choice;
  choice.frames.resize(run.times().size());
  std::iota(choice.frames.begin(), choice.frames.end(), 0);
  if (!options.colour.empty()) choice.quantity = field_quantity(options.colour);
  choice.chains = options.chains;
  choice.window = box_of(options.window);
  choice.range = range_of(options.range);
  const auto all = static_cast<double>(choice.frames.size());
  const FieldFigure figure = picture_of(run, choice, [&](size_t read) {
    line.report({"read", static_cast<double>(read) / all});
  });
  const TemporaryFolder folder;
  int drawn = 0;
  draw_each(figure, [&](const std::string& picture) {
    line.report({"drawn", drawn / all});
    write_file(fmt::format("{}/{:06}.png", folder.path(), drawn++), picture);
  });
  // The ending stays, because ffmpeg goes by it; the movie gets its name when it is complete.
  const std::string partial =
      folder.path() + "/movie" + fs::path(options.movie).extension().string();
  std::vector<std::string> words{"-y", "-framerate", fmt::format("{}", options.rate), "-i",
                                 folder.path() + "/%06d.png"};
  words.insert(words.end(), format.begin(), format.end());
  words.push_back(partial);
  const ProgramResult made = ffmpeg(words);
  line.check();
  const std::string movie = read_bytes(partial);
  if (made.start_error != 0 || made.code != 0 || movie.empty()) {
    throw std::runtime_error("ffmpeg has failed: " + made.err);
  }
  write_file(options.movie, movie);
}

}  // namespace apothem
