// Writes files that are either complete or absent, so that the files on disk stay valid when the
// disk is full or the run is killed.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace apothem {

/// Thrown when the system fails (disk full, no permission). The message names the file and the
/// system's reason.
class SystemFailure : public std::runtime_error {
 public:
  /// `error_number` is a value of errno.
  SystemFailure(const std::string& file, int error_number);
};

/// Creates a folder and its parents, unless they exist. Throws SystemFailure.
void create_folder(const std::string& folder);

/// A new folder among the temporary files, for this user alone, which is gone at the end.
class TemporaryFolder {
 public:
  /// Throws SystemFailure.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes a temporary file beside `file` and then renames it, so that an older file is replaced at
/// once. Throws SystemFailure; the older file is then intact. A device or a pipe is written to
/// directly.
void write_file(const std::string& file, std::string_view content);

/// Takes a part of a file.
using FileSink = std::function<void(std::string_view)>;

/// The same with a content that comes in parts. Exceptions of `write` are passed on, and leave the
/// older file as it is.
void write_file(const std::string& file, const std::function<void(const FileSink&)>& write);

/// A file that grows by whole blocks. A block that cannot be written in full is removed again. All
/// functions throw SystemFailure.
class AppendedFile {
 public:
  /// Opens an empty file, or keeps the first `size` bytes of an existing one.
  explicit AppendedFile(std::string file, std::int64_t size = 0);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  /// Adds a block at the end.
  void append(std::string_view block);
  /// Size in bytes.
  [[nodiscard]] std::int64_t size() const { return size_; }

 private:
  std::string file_;
  int descriptor_;
  std::int64_t size_;
};

}  // namespace apothem
