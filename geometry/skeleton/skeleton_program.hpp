// The helper program in which CGAL constructs straight skeletons: where it is, and what it is
// asked.
#pragma once

#include <string>

#include "geometry/skeleton/cgal_construction.hpp"

namespace apothem {

/// Begins a request; the numbers behind it are: 1 for exact constructions or 0, then for every
/// polygon the number of its rings, and for each of these the number of its vertices and their
/// coordinates. The answer has for every polygon the size of its SkeletonMessage and the message.
/// It changes with what follows it, so that a helper of another version refuses the request.
inline constexpr double kSkeletonRequest = 20262;

/// The path of the helper program: that of the environment variable APOTHEM_SKELETON_PROGRAM, or
/// the first of these that exists:
/// - beside the program or shared library that contains this code, or in `libexec/apothem` of one
///   of the folders around it: where `cmake --install` puts it,
/// - where the installed CMake package has it, for programs that link with the package, and
/// - where it was built.
/// Throws std::runtime_error if there is none.
std::string skeleton_program();

}  // namespace apothem
