#include "apothem/output/files.hpp"

#include <fcntl.h>
#include <unistd.h>

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

// Whether the name is that of a device or a pipe, as /dev/null. A new file would take its place.
bool is_device(const std::string& file) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

}  // namespace

SystemFailure::SystemFailure(const std::string& file, int error_number)
    : std::runtime_error(file + ": cannot be written: " + std::strerror(error_number) +
                         remedy(error_number)) {}

TemporaryFolder::TemporaryFolder()
    : path_((std::filesystem::temp_directory_path() / "apothem-XXXXXX").string()) {
  if (!::mkdtemp(path_.data())) throw SystemFailure(path_, errno);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void create_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw SystemFailure(folder, error.value());
  if (!std::filesystem::is_directory(folder)) throw SystemFailure(folder, ENOTDIR);
}

void write_file(const std::string& file, std::string_view content) {
  write_file(file, [&](const FileSink& sink) { sink(content); });
}

void write_file(const std::string& file, const std::function<void(const FileSink&)>& write) {
  const bool in_place = is_device(file);
  const std::string partial = in_place ? file : file + ".partial";
  const int descriptor = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) throw SystemFailure(file, errno);
  try {
    write([&](std::string_view part) {
      if (const int error = write_all(descriptor, part); error != 0) {
        throw SystemFailure(file, error);
      }
    });
  } catch (...) {
    ::close(descriptor);
    if (!in_place) ::unlink(partial.c_str());
    throw;
  }
  int error = 0;
  if (::close(descriptor) != 0) error = errno;
  if (error == 0 && !in_place && std::rename(partial.c_str(), file.c_str()) != 0) error = errno;
  if (error != 0) {
    if (!in_place) ::unlink(partial.c_str());
    throw SystemFailure(file, error);
  }
}

AppendedFile::AppendedFile(std::string file, std::int64_t size)
    : file_(std::move(file)),
      descriptor_(::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)),
      size_(size) {
  if (descriptor_ < 0 || ::ftruncate(descriptor_, size_) != 0 ||
      ::lseek(descriptor_, size_, SEEK_SET) < 0) {
    throw SystemFailure(file_, errno);
  }
}

AppendedFile::~AppendedFile() { ::close(descriptor_); }

void AppendedFile::append(std::string_view block) {
  if (const int error = write_all(descriptor_, block); error != 0) {
    if (::ftruncate(descriptor_, size_) == 0) ::lseek(descriptor_, size_, SEEK_SET);
    throw SystemFailure(file_, error);
  }
  size_ += static_cast<std::int64_t>(block.size());
}

}  // namespace apothem
