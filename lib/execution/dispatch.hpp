// Runs a kernel with the widest instructions that the processor has.
//
// The kernel is compiled once per instruction set. It must dissolve into its caller: a lambda
// marked APOTHEM_INLINE whose callees are marked likewise. With -ffp-contract=off every version
// rounds like the scalar one, so that the results have the same bits. Other processors than x86-64,
// among them Arm, run the version that the compiler makes of the packs by itself.
#pragma once

#include <type_traits>

#include "lib/execution/pack.hpp"

namespace apothem {

template <int lanes>
using Lanes = std::integral_constant<int, lanes>;

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)

// Under the sanitizers there is one version: three would take three times the minutes of
// compilation, for the same sums.
enum class Machine { any, avx2, avx512 };

inline Machine machine() {
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return Machine::avx512;
  }
  return __builtin_cpu_supports("avx2") ? Machine::avx2 : Machine::any;
}

template <class Kernel>
[[gnu::target("avx512f,avx512vl,avx512dq")]] double with_avx512(const Kernel& kernel) {
  return kernel(Lanes<8>());
}
template <class Kernel>
[[gnu::target("avx2")]] double with_avx2(const Kernel& kernel) {
  return kernel(Lanes<4>());
}

/// Calls the kernel and returns what it returns. Its argument says how wide packs should be: wider
/// ones than the registers would travel through memory.
template <class Kernel>
double with_widest(const Kernel& kernel) {
  static const Machine here = machine();
  if (here == Machine::avx512) return with_avx512(kernel);
  if (here == Machine::avx2) return with_avx2(kernel);
  return kernel(Lanes<4>());
}

#else

template <class Kernel>
double with_widest(const Kernel& kernel) {
  return kernel(Lanes<4>());
}

#endif

}  // namespace apothem
