// run.files in a folder of results: the names of all files that runs have made there, one a line,
// so that a later run knows which ones are not a user's own. A name is added before its file is
// made. The list is also the lock of the folder, which a process holds while it writes results
// there, and which the system frees however that process ends.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "lib/output/files.hpp"

namespace apothem {

class FileList {
 public:
  static constexpr const char* kName = "run.files";

  /// Opens the list in a folder, which is created if need be. Throws SystemFailure.
  explicit FileList(std::string folder);
  ~FileList();
  FileList(const FileList&) = delete;
  FileList& operator=(const FileList&) = delete;

  /// Locks the folder; then the list is as it stands in the file. False if another process has
  /// locked it. Where the file system has no locks, folders are not guarded. Throws SystemFailure.
  bool lock();
  /// Also removes the list if there is nothing in it. So does the end of this object.
  void unlock();

  /// Whether the file of this name is no list.
  [[nodiscard]] bool is_other_file() const { return size_ > 0 && identity_.empty(); }
  /// What the run is of that has made the files, as begin() was told; empty: there is no list yet.
  [[nodiscard]] const std::string& identity() const { return identity_; }
  /// In the order in which they were added.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(const std::string& name) const { return known_.count(name) > 0; }

  /// Begins the list anew, with these names. Throws SystemFailure.
  void begin(const std::string& identity, const std::vector<std::string>& names);
  /// Adds the names that are not there yet. Throws SystemFailure, also if the list has been deleted
  /// or changed meanwhile.
  void add(const std::vector<std::string>& names);
  /// As make_last().
  void make_last() const;

 private:
  void open();
  void read();
  std::string take_in(const std::vector<std::string>& names);
  void append(const std::string& lines);

  std::string folder_, file_;
  int descriptor_ = -1;
  bool locked_ = false;
  std::int64_t size_ = 0;
  std::string identity_;
  std::vector<std::string> names_;
  std::set<std::string> known_;
};

}  // namespace apothem
