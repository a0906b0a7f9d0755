#include "apothem/output/gnuplot.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>

namespace apothem {

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
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    std::filesystem::rename(where / partial, where / picture, failure);
    if (!failure) return Plotted::yes;
  }
  std::filesystem::remove(where / partial, failure);
  return Plotted::failed;
}

}  // namespace apothem
