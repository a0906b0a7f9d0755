#include "lib/system/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace apothem {
namespace {

// The limit of the group of processes in a container or a job of a cluster, bytes; none: `most`.
double limit_of_group(double most) {
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream stream(file);
    double bytes = 0;
    if (stream >> bytes && bytes > 0) most = std::min(most, bytes);
  }
  return most;
}

}  // namespace

double memory_limit() {
  double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
  }
  return limit_of_group(bytes);
}

double memory_used() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return 1024. * static_cast<double>(used.ru_maxrss);
}

}  // namespace apothem
