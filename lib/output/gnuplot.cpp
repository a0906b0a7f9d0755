#include "lib/output/gnuplot.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <string_view>

#include "lib/text/file.hpp"

namespace apothem {
namespace {

// Gnuplot does not tell that the disk was full.
bool is_complete(const std::filesystem::path& picture, bool svg) {
  std::string content = read_bytes(picture);
  while (svg && !content.empty() && content.back() == '\n') content.pop_back();
  constexpr std::string_view kEndOfPng("IEND\xae\x42\x60\x82", 8);
  return content.ends_with(svg ? "</svg>" : kEndOfPng);
}

}  // namespace

Plotted plot_with_gnuplot(const std::string& folder, const std::string& script,
                          const std::string& picture) {
  const std::string partial = picture + ".partial";
  std::string program = "gnuplot", option = "-e", output = "output='" + partial + "'";
  std::string file = script;
  const std::array<char*, 5> arguments{program.data(), option.data(), output.data(), file.data(),
                                       nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return Plotted::no_gnuplot;
  if (error != 0) return Plotted::failed;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::filesystem::path where(folder);
  std::error_code failure;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 &&
      is_complete(where / partial, picture.ends_with(".svg"))) {
    std::filesystem::rename(where / partial, where / picture, failure);
    if (!failure) return Plotted::yes;
  }
  std::filesystem::remove(where / partial, failure);
  return Plotted::failed;
}

}  // namespace apothem
