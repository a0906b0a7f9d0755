#include "lib/output/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace apothem {
namespace {

// Writes all bytes. Returns 0 or the number of the error.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return 0;
}

// What would help, as the end of a message.
const char* remedy(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "; make room, or choose another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "; choose a folder that you may write to";
    case ENOENT:
    case ENOTDIR:
      return "; choose a folder that can be made";
    default:
      return "";
  }
}

// What the system says, and what would help.
std::string reason_of(const std::string& file, int error_number) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (error_number == ENOENT && !folder.empty() && !std::filesystem::exists(folder, ignored)) {
    return "there is no folder \"" + folder.string() + "\"; make it, or choose another one";
  }
  return std::string(std::strerror(error_number)) + remedy(error_number);
}

// Whether the name is that of a device or a pipe, as /dev/null. A new file would take its place.
bool is_device(const std::string& file) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

// 0 or the number of the error. Some file systems know no such thing, and devices neither.
int sync(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
}

// Whether a name stands for the open file.
bool is_named(const std::string& file, const struct stat& open) {
  struct stat named {};
  return ::lstat(file.c_str(), &named) == 0 && named.st_dev == open.st_dev &&
         named.st_ino == open.st_ino;
}

// Opens the temporary file, empty, and locks it as far as the file system has locks: another
// process may be writing it, and rename it while this one waits. A link in its place is not
// followed.
int open_partial(const std::string& partial) {
  while (true) {
    const int descriptor =
        ::open(partial.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) return -1;
    struct stat open {};
    static_cast<void>(::flock(descriptor, LOCK_EX));
    if (::fstat(descriptor, &open) == 0 && is_named(partial, open)) {
      if (::ftruncate(descriptor, 0) == 0) return descriptor;
      const int error = errno;
      ::close(descriptor);
      errno = error;
      return -1;
    }
    ::close(descriptor);
  }
}

std::string folder_of(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

SystemFailure::SystemFailure(const std::string& file, const std::string& reason)
    : std::runtime_error(file + ": " + reason) {}

SystemFailure::SystemFailure(const std::string& file, int error_number)
    : std::runtime_error(file + ": cannot be written: " + reason_of(file, error_number)) {}

TemporaryFolder::TemporaryFolder()
    : path_((std::filesystem::temp_directory_path() / "apothem-XXXXXX").string()) {
  if (!::mkdtemp(path_.data())) throw SystemFailure(path_, errno);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

bool file_exists(const std::string& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored);
}

void create_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SystemFailure(folder, error.value());
  if (!std::filesystem::is_directory(folder)) throw SystemFailure(folder, ENOTDIR);
}

void write_file(const std::string& file, std::string_view content, Lasting lasting) {
  write_file(
      file, [&](const FileSink& sink) { sink(content); }, lasting);
}

void write_file(const std::string& file, const std::function<void(const FileSink&)>& write,
                Lasting lasting) {
  const bool in_place = is_device(file);
  const std::string partial = in_place ? file : file + ".partial";
  const int descriptor =
      in_place ? ::open(partial.c_str(), O_WRONLY | O_CLOEXEC) : open_partial(partial);
  if (descriptor < 0) throw SystemFailure(file, errno);
  try {
    write([&](std::string_view part) {
      if (const int error = write_all(descriptor, part); error != 0) {
        throw SystemFailure(file, error);
      }
    });
  } catch (...) {
    if (!in_place) ::unlink(partial.c_str());
    ::close(descriptor);
    throw;
  }
  // Renamed before it is closed, which gives the lock free.
  int error = lasting == Lasting::yes ? sync(descriptor) : 0;
  if (error == 0 && !in_place && std::rename(partial.c_str(), file.c_str()) != 0) error = errno;
  if (error != 0 && !in_place) ::unlink(partial.c_str());
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error != 0) throw SystemFailure(file, error);
  if (lasting == Lasting::yes && !in_place) make_last(folder_of(file));
}

void make_last(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw SystemFailure(path, errno);
  const int error = sync(descriptor);
  ::close(descriptor);
  if (error != 0) throw SystemFailure(path, error);
}

FilePart part_of(const std::string& file, std::int64_t size) {
  FilePart part;
  if (size == 0) return part;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw SystemFailure(file, errno);
  std::array<char, 1 << 16> block{};
  while (part.size < size) {
    const auto wanted = std::min<std::int64_t>(size - part.size, block.size());
    const ssize_t count = ::read(descriptor, block.data(), static_cast<size_t>(wanted));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error = errno;
      ::close(descriptor);
      throw SystemFailure(file, std::string("cannot be read: ") + std::strerror(error));
    }
    if (count == 0) break;
    part.checksum.add(block.data(), static_cast<size_t>(count));
    part.size += count;
  }
  ::close(descriptor);
  return part;
}

bool is_untouched(const std::string& file, int descriptor, std::int64_t size) {
  struct stat open {};
  return ::fstat(descriptor, &open) == 0 && open.st_size == size && is_named(file, open);
}

void require_untouched(const std::string& file, int descriptor, std::int64_t size) {
  struct stat open {};
  if (::fstat(descriptor, &open) != 0) throw SystemFailure(file, errno);
  if (!is_named(file, open)) {
    throw SystemFailure(file,
                        "has been deleted or replaced while the run was writing it; run it anew, "
                        "with --overwrite");
  }
  if (open.st_size != size) {
    throw SystemFailure(
        file, "has been changed by somebody else while the run was writing it: it is " +
                  std::to_string(open.st_size) + " bytes long and not " + std::to_string(size) +
                  "; run it anew, with --overwrite");
  }
}

AppendedFile::AppendedFile(std::string file, const FilePart& kept)
    : file_(std::move(file)),
      descriptor_(::open(file_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)),
      part_(kept) {
  if (descriptor_ < 0 || ::ftruncate(descriptor_, part_.size) != 0 ||
      ::lseek(descriptor_, part_.size, SEEK_SET) < 0) {
    throw SystemFailure(file_, errno);
  }
}

AppendedFile::~AppendedFile() { ::close(descriptor_); }

void AppendedFile::append(std::string_view block) {
  require_untouched(file_, descriptor_, part_.size);
  if (const int error = write_all(descriptor_, block); error != 0) {
    if (::ftruncate(descriptor_, part_.size) == 0) ::lseek(descriptor_, part_.size, SEEK_SET);
    throw SystemFailure(file_, error);
  }
  part_.checksum.add(block);
  part_.size += static_cast<std::int64_t>(block.size());
}

void AppendedFile::make_last() const {
  if (const int error = sync(descriptor_); error != 0) throw SystemFailure(file_, error);
}

}  // namespace apothem
