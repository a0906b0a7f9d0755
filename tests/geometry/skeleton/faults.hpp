// What the helper program of the tests is asked for.
#pragma once

namespace apothem::test {

/// What goes wrong after the other numbers of the request have been sent back. `report`: nothing,
/// but the process group follows, whether interrupts are ignored, and whether file 3 is open.
enum class Fault { none, crash, kill, loop, sleep, greed, exception, report };

}  // namespace apothem::test
