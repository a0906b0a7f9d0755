#include "apothem/execution/parallel.hpp"

#include <omp.h>

namespace apothem {

void Threads::run(void (*work)(void*, int, int), void* task) const {
#pragma omp parallel num_threads(count_)
  work(task, omp_get_thread_num(), omp_get_num_threads());
}

}  // namespace apothem
