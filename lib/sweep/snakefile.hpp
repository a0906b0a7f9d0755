// A study as a workflow of Snakemake (https://snakemake.github.io), which distributes its parts to
// the cores of a machine or, through a profile, to the jobs of a cluster.
#pragma once

#include <string>
#include <vector>

namespace apothem {

struct WorkflowParts {
  std::vector<std::string> command;  ///< words of the sweep without its part; paths are absolute
  std::vector<std::string> inputs;   ///< files after whose change the parts are done again
  std::string folder;                ///< of the study, absolute
  size_t shards = 1;                 ///< number of parts
  int jobs = 1;                      ///< runs at a time in each part
};

/// The text of a Snakefile: one rule for the parts and one for the tables.
std::string snakefile(const WorkflowParts& parts);

}  // namespace apothem
