// How much memory there is.
#pragma once

namespace apothem {

/// Bytes that this process may use at most: what the machine has, or less where the process or its
/// group is limited (ulimit -v, cgroups).
double memory_limit();

/// The largest number of bytes that this process has used so far.
double memory_used();

}  // namespace apothem
