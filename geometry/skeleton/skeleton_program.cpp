#include "geometry/skeleton/skeleton_program.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace apothem {

/// Of the installed CMake package: defined in a source file that it adds to programs of others
/// (cmake/package_program.cpp).
[[gnu::weak]] const char* skeleton_program_of_package();

namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "APOTHEM_SKELETON_PROGRAM";
constexpr const char* kName = "apothem-skeleton";
constexpr int kFoldersAround = 6;  // as many as PREFIX has above lib/python3/dist-packages/apothem

// The program or shared library that contains this code.
fs::path own_file() {
  std::error_code error;
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&skeleton_program), &info) != 0 && info.dli_fname) {
    const fs::path file = fs::canonical(info.dli_fname, error);
    if (!error && file.filename().string().find(".so") != std::string::npos) return file;
  }
  return fs::read_symlink("/proc/self/exe", error);
}

std::string find_program() {
  std::error_code error;
  fs::path folder = own_file().parent_path();
  if (fs::path beside = folder / kName; fs::exists(beside, error)) return beside;
  for (int i = 0; i < kFoldersAround && folder.has_relative_path(); ++i) {
    const fs::path installed = folder / APOTHEM_LIBEXEC / kName;
    if (fs::exists(installed, error)) return installed;
    folder = folder.parent_path();
  }
  if (skeleton_program_of_package && fs::exists(skeleton_program_of_package(), error)) {
    return skeleton_program_of_package();
  }
  if (fs::exists(APOTHEM_SKELETON_BUILT, error)) return APOTHEM_SKELETON_BUILT;
  throw std::runtime_error(std::string("the helper program ") + kName +
                           ", which constructs straight skeletons, was not found beside " +
                           own_file().string() +
                           " nor in " APOTHEM_LIBEXEC
                           " of its prefix: install Apothem as a whole, or give its path in the "
                           "environment variable " +
                           kVariable);
}

}  // namespace

std::string skeleton_program() {
  if (const char* given = std::getenv(kVariable); given && *given) return given;
  static const std::string found = find_program();
  return found;
}

}  // namespace apothem
