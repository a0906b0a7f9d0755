// What the tests must know of the build folder that they are linked in: the only source of theirs
// that is compiled there where their other objects come from another folder.
#include "tests/this_build.hpp"

namespace apothem::test {

bool is_sanitized() { return APOTHEM_SANITIZED; }
const char* program() { return APOTHEM_PROGRAM; }
const char* faulty_helper() { return APOTHEM_FAULTY_HELPER; }

}  // namespace apothem::test
