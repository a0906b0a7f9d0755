// The descriptors that every process begins with.
#pragma once

namespace apothem {

/// Opens standard input, output and error on /dev/null where they are closed. A file that is opened
/// later would get the number of the missing one, and what is printed would go into it.
void open_standard_files() noexcept;

}  // namespace apothem
