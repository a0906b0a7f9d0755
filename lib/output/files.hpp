// Files that are either complete or not there: what stands on disk stays valid when the disk fills
// up or the run is killed.
#pragma once

#include <cstdint>
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
  /// Starts empty, or keeps the first `size` bytes of an existing file.
  explicit AppendedFile(std::string file, std::int64_t size = 0);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  void append(std::string_view block);
  [[nodiscard]] std::int64_t size() const { return size_; }

 private:
  std::string file_;
  int descriptor_;
  std::int64_t size_;
};

}  // namespace apothem
