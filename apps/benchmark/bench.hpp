// Private header: what `apothem benchmark` times, and how.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace apothem {

/// Keeps the compiler from leaving out the computation of a value.
template <class T>
inline void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

/// Numbers that a case may tell beside its time, in the order of the columns of tables.
struct NamedExtra {
  std::string_view name, unit;
};
inline constexpr std::array kExtras{
    NamedExtra{"touching", "per body"},  // pairs of bodies that overlap; of meshes edges and faces
    NamedExtra{"candidates", "per body"},  // pairs that are near each other, likewise
    NamedExtra{"memory", "bytes per body"},
    NamedExtra{"speed", "m/s"},  // root of the mean square of the bodies' velocities at the end
    NamedExtra{"integrate", "share"},
    NamedExtra{"elements", "share"},
    NamedExtra{"place", "share"},
    NamedExtra{"search", "share"},
    NamedExtra{"contact", "share"},
    NamedExtra{"gather", "share"},
    NamedExtra{"error", ""},
    NamedExtra{"failures", ""},
    NamedExtra{"patches", "per pair"},
    NamedExtra{"attempts", ""},
    NamedExtra{"crossings", "per vertex"},  // of the boundaries of a pair
    NamedExtra{"speedup", ""},
    NamedExtra{"same_bits", ""},
};

struct Extra {
  std::string_view name;  ///< one of kExtras
  double value;
};

/// A case that is ready to be timed.
struct Work {
  /// Does the work once and returns of how many items. If it has `before`, that is called first,
  /// and does not count.
  std::function<double()> once;
  std::function<void()> before = {};
  /// Of an item, if known: bytes that have to come from memory or go there, and floating-point
  /// operations.
  double bytes = 0, operations = 0;
  /// Asked after all repetitions.
  std::function<std::vector<Extra>()> extras = {};
};

/// Time of the process, or time of the clock on the wall, which children and threads need.
enum class ClockKind { processor, wall };

struct BenchmarkCase {
  std::string name;   ///< the same in all versions, so that these can be compared
  std::string item;   ///< what a time is of
  std::string about;  ///< in a few words
  std::function<Work(int threads)> prepare = {};
  /// Bodies or elements, where it says how time grows with them; the cases of a family have the
  /// same name up to the last slash.
  double size = 0;
  bool on_request = false;  ///< takes long: only where it is asked for by a filter
  ClockKind clock = ClockKind::processor;
};

/// A case for each size, all of one family. make(size, threads) prepares it; sizes above `usual`
/// are timed on request only.
void add_family(std::vector<BenchmarkCase>& cases, const BenchmarkCase& all,
                std::initializer_list<int> sizes,
                const std::function<Work(int size, int threads)>& make, int usual = 1 << 30);

/// All cases, in the order in which they are listed.
std::vector<BenchmarkCase> benchmark_cases();

/// Those of each file.
std::vector<BenchmarkCase> machine_cases();
std::vector<BenchmarkCase> pair_cases();
std::vector<BenchmarkCase> contact_cases();
std::vector<BenchmarkCase> element_cases();
std::vector<BenchmarkCase> scene_cases();
std::vector<BenchmarkCase> start_cases();
std::vector<BenchmarkCase> rest_cases();
std::vector<BenchmarkCase> big_polygon_cases();
std::vector<BenchmarkCase> work_cases();

/// How often and for how long a case is timed.
struct Timing {
  int repetitions = 5;
  double seconds = .1;  ///< that a repetition takes at least
  int threads = 1;
};

/// A case that has been timed.
struct Timed {
  std::vector<double> times;  ///< of an item, s, of each repetition
  double bytes = 0, operations = 0;
  std::vector<Extra> extras;

  [[nodiscard]] double median() const;
  [[nodiscard]] double least() const;
  [[nodiscard]] double largest() const;
};

/// With more than one thread all clocks are those on the wall.
Timed time_case(const BenchmarkCase& benchmark, const Timing& timing);

double median_of(std::vector<double> values);

/// What one core can do, measured: bytes and operations per second.
struct MachineLimits {
  double bandwidth = 0, arithmetic = 0;
};
MachineLimits machine_limits(const Timing& timing);
inline constexpr std::string_view kBandwidthCase = "machine_memory";
inline constexpr std::string_view kArithmeticCase = "machine_arithmetic";

}  // namespace apothem
