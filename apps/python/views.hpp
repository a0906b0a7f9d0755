// What a simulation shows of its bodies, nodes and elements.
#pragma once

#include "apps/python/driver.hpp"

namespace apothem::python {

struct Bodies {
  std::shared_ptr<SharedRun> run;
};
struct Nodes {
  std::shared_ptr<SharedRun> run;
};
struct Elements {
  std::shared_ptr<SharedRun> run;
};

}  // namespace apothem::python
