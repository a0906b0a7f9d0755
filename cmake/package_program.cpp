// The installed CMake package adds this file to programs that link with it: it tells Apothem's
// library where the package has the helper program.

namespace apothem {
[[gnu::weak]] const char* skeleton_program_of_package() { return APOTHEM_SKELETON_PROGRAM; }
}  // namespace apothem
