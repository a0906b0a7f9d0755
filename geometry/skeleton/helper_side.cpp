#include "geometry/skeleton/helper_side.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "lib/system/standard_files.hpp"

namespace apothem {
namespace {

constexpr double kMemory = 4e9;  // bytes that the work may map

void write_all(const std::vector<double>& numbers) {
  const char* data = reinterpret_cast<const char*>(numbers.data());
  size_t left = numbers.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = write(STDOUT_FILENO, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);  // nobody reads any more
    data += written;
    left -= static_cast<size_t>(written);
  }
}

std::vector<double> read_all() {
  std::vector<double> numbers;
  double part[4096];
  size_t bytes = 0;
  while (true) {
    const ssize_t count =
        read(STDIN_FILENO, reinterpret_cast<char*>(part) + bytes, sizeof part - bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return numbers;
    bytes += static_cast<size_t>(count);
    const size_t whole = bytes / sizeof(double);
    numbers.insert(numbers.end(), part, part + whole);
    bytes -= whole * sizeof(double);
    std::copy_n(reinterpret_cast<char*>(part + whole), bytes, reinterpret_cast<char*>(part));
  }
}

// The kernel ends the process after so much more processor time. This also works if the program
// that has started the helper has died and cannot kill it any more.
void limit_processor_time(double seconds) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  rlimit time{};
  getrlimit(RLIMIT_CPU, &time);
  time.rlim_cur =
      std::min(time.rlim_max, static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1) +
                                  static_cast<rlim_t>(std::ceil(seconds)));
  setrlimit(RLIMIT_CPU, &time);
}

// The memory that this process has mapped, in bytes. The limit has to be counted from there, since
// a sanitizer maps terabytes.
double mapped_bytes() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// False if this process may not have as much as its work may map.
bool limit_memory() {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  rlimit memory{};
  getrlimit(RLIMIT_AS, &memory);
  const auto wanted = static_cast<rlim_t>(mapped_bytes() + kMemory);
  const bool enough = memory.rlim_max >= wanted;
  memory.rlim_cur = std::min(memory.rlim_max, wanted);
  setrlimit(RLIMIT_AS, &memory);
  return enough;
}

}  // namespace

void serve_request(int argc, char** argv, const HelperWork& work) {
  open_standard_files();
  const long parent = argc == 3 ? std::strtol(argv[1], nullptr, 10) : 0;
  const double seconds = argc == 3 ? std::strtod(argv[2], nullptr) : 0;
  if (parent <= 0 || !(seconds > 0)) {
    std::fprintf(stderr, "%s: a part of Apothem, which starts it by itself\n", argv[0]);
    std::exit(2);
  }
  work_as_helper(static_cast<int>(parent), seconds,
                 [&](const SendNumbers& send) { work(read_all(), send); });
}

void work_as_helper(int parent, double seconds,
                    const std::function<void(const SendNumbers&)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has died already
  limit_processor_time(seconds);
  const bool enough = limit_memory();
  try {
    work([&](const std::vector<double>& numbers) {
      write_all(numbers);
      limit_processor_time(seconds);
    });
  } catch (const std::bad_alloc&) {
    _exit(enough ? 1 : kWithoutMemory);  // with enough of it, the work asks for too much
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

}  // namespace apothem
