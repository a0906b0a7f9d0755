#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/picture/movie.hpp"
#include "lib/output/files.hpp"
#include "lib/player/player.hpp"
#include "lib/text/file.hpp"
#include "version.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;

// The name of the scene, as far as the run has got to say it; otherwise that of the folder.
std::string name_of(const std::string& folder) {
  const auto json = nlohmann::json::parse(find_text(folder + "/run.json"), nullptr, false);
  const auto name = json.find("name");
  return name != json.end() && name->is_string() ? name->get<std::string>() : folder_title(folder);
}

}  // namespace

int view_command(const ViewOptions& options) {
  if (!options.movie.empty()) {
    write_movie(options);
    fmt::print("{}\n", options.movie);
    return exit_code::done;
  }
  const std::string file =
      options.output.empty() ? (fs::path(options.folder) / "view.html").string() : options.output;
  if (!file.ends_with(".html") && !file.ends_with(".htm")) {
    throw UsageError("--output",
                     fmt::format("{} is no page; give a name that ends with .html", file));
  }
  const RunFolder run(options.folder);
  const std::string page =
      player_page(run, name_of(options.folder), fmt::format("apothem {}", kVersion));
  write_file(file, page);
  fmt::print("{}: {} frames, {:.1f} MB\n", file, run.times().size(),
             static_cast<double>(page.size()) / 1e6);
  return exit_code::done;
}

}  // namespace apothem
