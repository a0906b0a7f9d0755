#include "lib/system/standard_files.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace apothem {

void open_standard_files() noexcept {
  // The lowest free number is given to the file that is opened.
  int descriptor = 0;
  while (descriptor >= 0 && descriptor <= STDERR_FILENO) descriptor = open("/dev/null", O_RDWR);
  if (descriptor > STDERR_FILENO) close(descriptor);
}

}  // namespace apothem
