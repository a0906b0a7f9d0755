// Which files are read as input: regular ones of a size that memory holds.
#pragma once

#include <cstddef>
#include <string>

namespace apothem {

/// Why a file cannot be read as input, and what would be right; empty if it can be. It must be
/// there and be a regular file, or a pipe that this process has been given, as a shell's <(...): a
/// device need not end, and a named pipe may wait for a writer for ever. The file is not opened.
std::string refusal_of_input(const std::string& file);

/// The same, also where the file is larger than `limit` (bytes) or what the environment says in its
/// place, see input_limit.
std::string refusal_of_input(const std::string& file, size_t limit);

/// What to say of a file that could not be opened: the system's reason (a value of errno), and what
/// would be right.
std::string cannot_open(const std::string& file, int error);

/// Bytes of the largest file that is read: `usual`, or the number of MiB that the environment
/// variable APOTHEM_INPUT_LIMIT holds.
size_t input_limit(size_t usual);

/// The refusal of a file that is larger than `limit`, which is in force.
std::string too_large(size_t limit);

}  // namespace apothem
