// The end of the program where memory runs out and no exception says so.
#pragma once

namespace apothem {

/// Has the program end with one sentence and exit code 4 where memory has run out in a thread or in
/// a library that cannot bear it. Called once, from main().
void heed_lack_of_memory();

}  // namespace apothem
