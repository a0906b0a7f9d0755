// Where the tests find what was built with them.
#pragma once

namespace apothem::test {

/// Whether the libraries are built with the sanitizers, which make everything 20 times slower.
bool is_sanitized();
/// Path of the program under test.
const char* program();
/// Path of the helper program that fails on request (geometry/skeleton/faulty_helper.cpp).
const char* faulty_helper();

}  // namespace apothem::test
