// Writes files that are either complete or absent, so that the files on disk stay valid when the
// disk is full or the run is killed.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "lib/output/checksum.hpp"

namespace apothem {

/// Thrown when the system fails (disk full, no permission). The message names the file and the
/// system's reason.
class SystemFailure : public std::runtime_error {
 public:
  /// `error_number` is a value of errno.
  SystemFailure(const std::string& file, int error_number);
  /// `reason`: what has happened to the file, and what helps.
  SystemFailure(const std::string& file, const std::string& reason);
};

/// Whether there is something of that name, as far as this process can see.
bool file_exists(const std::string& file);

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

/// Whether a file outlasts a machine that stops, which takes some milliseconds.
enum class Lasting : bool { no, yes };

/// Writes a temporary file beside `file` and then renames it, so that an older file is replaced at
/// once. Throws SystemFailure; the older file is then intact. A device or a pipe is written to
/// directly. Of several processes that write the same file at a time, one waits for the other.
void write_file(const std::string& file, std::string_view content, Lasting lasting = Lasting::no);

/// Takes a part of a file.
using FileSink = std::function<void(std::string_view)>;

/// The same with a content that comes in parts. Exceptions of `write` are passed on, and leave the
/// older file as it is.
void write_file(const std::string& file, const std::function<void(const FileSink&)>& write,
                Lasting lasting = Lasting::no);

/// Sees to it that a file, or the names in a folder, outlast a machine that stops. Throws
/// SystemFailure.
void make_last(const std::string& path);

/// The beginning of a file, by its length in bytes and a checksum.
struct FilePart {
  std::int64_t size = 0;
  Checksum checksum = {};
};
/// The first `size` bytes of a file, or all of it if it is shorter. Throws SystemFailure if it
/// cannot be read.
FilePart part_of(const std::string& file, std::int64_t size);

/// A file that grows by whole blocks. A block that cannot be written in full is removed again. All
/// functions throw SystemFailure.
class AppendedFile {
 public:
  /// Opens an empty file, or keeps the part of an existing one, which it must begin with. No link
  /// is followed.
  explicit AppendedFile(std::string file, const FilePart& kept = {});
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;
  /// Adds a block at the end. Fails if the file has been deleted, replaced, or changed in size
  /// since.
  void append(std::string_view block);
  /// As make_last().
  void make_last() const;
  /// All of it.
  [[nodiscard]] const FilePart& part() const { return part_; }

 private:
  std::string file_;
  int descriptor_;
  FilePart part_;
};

/// Whether `file` is still the file behind a descriptor, and `size` bytes long.
bool is_untouched(const std::string& file, int descriptor, std::int64_t size);
/// Throws SystemFailure if it is not.
void require_untouched(const std::string& file, int descriptor, std::int64_t size);

}  // namespace apothem
