// The side of the helper program: reads its request, limits itself, and sends numbers back.
#pragma once

#include <functional>
#include <vector>

namespace apothem {

/// Exit code of a helper that the machine has refused memory below its own limit.
inline constexpr int kWithoutMemory = 3;

/// Sends numbers to the program that has started the helper. The work may call it any number of
/// times; each time the limit of the processor time begins anew.
using SendNumbers = std::function<void(const std::vector<double>&)>;

/// The work of a helper on its request.
using HelperWork = std::function<void(const std::vector<double>& request, const SendNumbers& send)>;

/// The main function of a helper program. Its arguments are the process that has started it and the
/// limit of the processor time in s, as run_helpers gives them; called by hand, it says so.
[[noreturn]] void serve_request(int argc, char** argv, const HelperWork& work);

/// Limits this process as run_helpers says, does the work, which sends its numbers to standard
/// output, and ends the process. `parent`: the process that has started this one.
[[noreturn]] void work_as_helper(int parent, double seconds,
                                 const std::function<void(const SendNumbers&)>& work);

}  // namespace apothem
