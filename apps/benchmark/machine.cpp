// What one core of the machine can do.

#include <memory>
#include <utility>

#include "apps/benchmark/bench.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {
namespace {

// Memory: a = b + s c on arrays far larger than the caches (J. McCalpin, STREAM).
Work memory(int) {
  struct Arrays {
    std::vector<double> a, b, c;
  };
  const auto arrays = std::make_shared<Arrays>();
  arrays->a.resize(1 << 24);
  arrays->b.assign(arrays->a.size(), 1);
  arrays->c.assign(arrays->a.size(), 2);
  return {.once = [arrays] {
    double* a = arrays->a.data();
    const double *b = arrays->b.data(), *c = arrays->c.data();
    const size_t n = arrays->a.size();
    for (size_t i = 0; i < n; ++i) a[i] = b[i] + 3 * c[i];
    keep(*a);
    return 24. * static_cast<double>(n);
  }};
}

// Arithmetic: as many independent chains of multiplications and additions as registers hold, so
// that none waits for its own last result. Returns the number of operations.
template <class Wide, size_t... chain>
APOTHEM_INLINE double chains(std::index_sequence<chain...>) {
  constexpr int kTurns = 1000;
  Wide start[sizeof...(chain)]{};
  keep(start);  // the compiler must not know that all chains are the same
  Wide p[]{start[chain]...};
  for (int i = 0; i < kTurns; ++i) {
    ((p[chain] = p[chain] * 1.0000001 + 1e-9), ...);
  }
  ((start[chain] = p[chain]), ...);
  keep(start);
  constexpr size_t kWidth = sizeof(Wide) / sizeof(double);
  return 2. * kTurns * static_cast<double>(sizeof...(chain) * kWidth);
}
#if defined(__x86_64__)
using Eight = double __attribute__((vector_size(64)));
using Four = double __attribute__((vector_size(32)));
[[gnu::target("avx512f")]] double chains_avx512() {
  return chains<Eight>(std::make_index_sequence<24>());
}
[[gnu::target("avx2")]] double chains_avx2() {
  return chains<Four>(std::make_index_sequence<12>());
}
#endif
using Two = double __attribute__((vector_size(16)));
double chains_plain() { return chains<Two>(std::make_index_sequence<12>()); }

Work arithmetic(int) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return {.once = chains_avx512};
  if (__builtin_cpu_supports("avx2")) return {.once = chains_avx2};
#endif
  return {.once = chains_plain};
}

}  // namespace

std::vector<BenchmarkCase> machine_cases() {
  return {{.name = std::string(kBandwidthCase),
           .item = "byte",
           .about = "STREAM's triad: read two arrays that no cache holds, write a third",
           .prepare = memory},
          {.name = std::string(kArithmeticCase),
           .item = "operation",
           .about = "multiply and add in wide registers, without fused operations",
           .prepare = arithmetic}};
}

}  // namespace apothem
