// Files that are either complete or not there: what stands on disk stays valid when the disk fills
// up or the run is killed.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace apothem {

/// The system failed (disk full, no permission): names the file and the system's reason.
class SystemFailure : public std::runtime_error {
 public:
  SystemFailure(const std::string& file, int error_number);
};

/// Creates a folder and its parents. Throws SystemFailure.
void create_folder(const std::string& folder);

/// Writes beside the target, then renames over it. Throws SystemFailure; the old file is then
/// intact.
void write_file(const std::string& file, std::string_view content);

/// A file that grows by whole blocks: a block that does not fit is taken back. Throws
/// SystemFailure.
class AppendedFile {
 public:
  explicit AppendedFile(std::string file);  ///< starts empty
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  void append(std::string_view block);

 private:
  std::string file_;
  int descriptor_;
};

}  // namespace apothem
