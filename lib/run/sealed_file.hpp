// Files of JSON that end with a checksum of all that stands before it, so that damage is found.
// Private to the room.
#pragma once

#include <functional>
#include <string>

#include "lib/archive/archive.hpp"
#include "lib/text/error.hpp"

namespace apothem {

/// A sealed file that is not as it was written.
class Damaged : public SceneError {
 public:
  Damaged(const std::string& file, const std::string& fault)
      : SceneError(file, fault + "; run it anew"), fault_(file + ": " + fault) {}
  /// The file and what is wrong, without the remedy.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
};

/// Writes a file that outlasts a machine that stops: an object with what `write` writes and its
/// checksum. Throws SystemFailure; an older file is then intact.
void write_sealed(const std::string& file, const std::function<void(Archive&)>& write);

/// The text of a sealed file. Throws Damaged, also if it has no checksum, and SceneError if it
/// cannot be read.
std::string read_sealed(const std::string& file);

}  // namespace apothem
