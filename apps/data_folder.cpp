#include "apps/data_folder.hpp"

#include <filesystem>

#include "version.hpp"

namespace apothem {

std::string data_folder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path installed = (program / kDataFromProgram).lexically_normal();
  if (fs::exists(installed / "figures", error)) return installed.string();
  return kSourceData;
}

}  // namespace apothem
