// A helper program in which everything goes wrong that can: its request begins with a Fault.
#include <unistd.h>

#include <csignal>
#include <memory>
#include <stdexcept>

#include "geometry/skeleton/helper_side.hpp"
#include "tests/geometry/skeleton/faults.hpp"

namespace {

using namespace apothem;
using test::Fault;

void work(const std::vector<double>& request, const SendNumbers& send) {
  send({request.begin() + 1, request.end()});
  switch (static_cast<Fault>(request.at(0))) {
    case Fault::none:
      break;
    case Fault::crash:
      std::raise(SIGABRT);
      break;
    case Fault::kill:
      std::raise(SIGKILL);
      break;
    case Fault::loop: {
      volatile bool forever = true;
      while (forever) {
      }
      break;
    }
    case Fault::sleep:
      while (true) sleep(1);
    case Fault::greed: {
      // Asked for in pieces that no allocator refuses by itself.
      std::vector<std::unique_ptr<std::vector<double>>> pieces;
      while (true) pieces.push_back(std::make_unique<std::vector<double>>(1 << 24));
    }
    case Fault::exception:
      throw std::runtime_error("no");
    case Fault::report:
      send({static_cast<double>(getpgrp()), std::signal(SIGINT, SIG_DFL) == SIG_IGN ? 1. : 0.,
            lseek(3, 0, SEEK_CUR) < 0 ? 0. : 1.});
  }
}

}  // namespace

int main(int argc, char** argv) { serve_request(argc, argv, work); }
