// What one core of the machine can do.

#include <memory>

#include "apothem/execution/pack.hpp"
#include "benchmark/bench.hpp"

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

// Arithmetic: independent multiplications and additions in registers. Returns their number.
template <size_t count>
APOTHEM_INLINE double chains() {
  constexpr int kTurns = 1000;
  std::array<Pack, count> start{};
  keep(start);  // the compiler must not know that all chains are the same
  std::array<Pack, count> p = start;
  const Pack factor(1.0000001), term(1e-9);
  for (int i = 0; i < kTurns; ++i) {
    for (Pack& x : p) x = x * factor + term;
  }
  start = p;
  keep(start);
  return 2. * kTurns * kLanes * static_cast<double>(count);
}
#if defined(__x86_64__)
[[gnu::target("avx512f")]] double chains_avx512() { return chains<12>(); }
[[gnu::target("avx2")]] double chains_avx2() { return chains<6>(); }
#endif
double chains_plain() { return chains<3>(); }

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
