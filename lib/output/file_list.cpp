#include "lib/output/file_list.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>

namespace apothem {
namespace {

constexpr std::string_view kHead = "# files of an apothem run of ";

bool is_clean(const std::string& name) {
  return !name.empty() && name.find('\0') == std::string::npos;
}

}  // namespace

FileList::FileList(std::string folder) : folder_(std::move(folder)), file_(folder_ + "/" + kName) {
  create_folder(folder_);
  open();
  read();
}

FileList::~FileList() {
  unlock();
  ::close(descriptor_);
}

void FileList::open() {
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw SystemFailure(file_, errno);
}

bool FileList::lock() {
  if (locked_) return true;
  while (true) {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    // Whoever held it before may have removed it.
    const off_t size = ::lseek(descriptor_, 0, SEEK_END);
    if (size < 0) throw SystemFailure(file_, errno);
    if (is_untouched(file_, descriptor_, size)) break;
    ::close(descriptor_);
    open();
  }
  locked_ = true;
  read();
  return true;
}

void FileList::unlock() {
  if (!locked_) return;
  if (size_ == 0) ::unlink(file_.c_str());
  static_cast<void>(::flock(descriptor_, LOCK_UN));
  locked_ = false;
}

// What is behind the last line break, or no list at all, counts as nothing.
void FileList::read() {
  identity_.clear();
  names_.clear();
  known_.clear();
  std::string text;
  std::array<char, 1 << 16> block{};
  ::lseek(descriptor_, 0, SEEK_SET);
  for (ssize_t n = 0; (n = ::read(descriptor_, block.data(), block.size())) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw SystemFailure(file_, errno);
    text.append(block.data(), static_cast<size_t>(n));
  }
  size_ = static_cast<std::int64_t>(text.size());
  text.resize(text.rfind('\n') + 1);  // to nothing if there is none
  std::istringstream lines(text);
  std::string line;
  if (!std::getline(lines, line) || !line.starts_with(kHead)) return;
  identity_ = line.substr(kHead.size());
  while (std::getline(lines, line)) {
    if (is_clean(line) && known_.insert(line).second) names_.push_back(line);
  }
}

void FileList::begin(const std::string& identity, const std::vector<std::string>& names) {
  if (::ftruncate(descriptor_, 0) != 0) throw SystemFailure(file_, errno);
  size_ = 0;
  names_.clear();
  known_.clear();
  identity_ = identity;
  append(std::string(kHead) + identity + '\n' + take_in(names));
}

void FileList::add(const std::vector<std::string>& names) {
  const std::string lines = take_in(names);
  if (!lines.empty()) append(lines);
}

// The lines of the names that are new.
std::string FileList::take_in(const std::vector<std::string>& names) {
  std::string lines;
  for (const std::string& name : names) {
    if (!known_.insert(name).second) continue;
    names_.push_back(name);
    lines += name + '\n';
  }
  return lines;
}

void FileList::append(const std::string& lines) {
  require_untouched(file_, descriptor_, size_);
  for (size_t at = 0; at < lines.size();) {
    const ssize_t n = ::pwrite(descriptor_, lines.data() + at, lines.size() - at, size_);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw SystemFailure(file_, errno);
    at += static_cast<size_t>(n);
    size_ += n;
  }
}

void FileList::make_last() const { apothem::make_last(file_); }

}  // namespace apothem
