#include "lib/sweep/snakefile.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace apothem {

std::string snakefile(const WorkflowParts& parts) {
  // Strings and lists of JSON are those of Python.
  const auto python = [](const nlohmann::json& value) { return value.dump(); };
  return fmt::format(
      R"py(# A study in parts, and its tables at the end. Written by apothem sweep --workflow snakemake.
#   snakemake -s Snakefile -j 4                 on this machine, four cores
#   snakemake -s Snakefile --profile PROFILE    on a cluster
import shlex

SWEEP = shlex.join({command})
FOLDER = {folder}
SHARDS = {shards}


# In both rules, exit code 1 says that runs have failed; runs.csv says which and why.
rule tables:
    input:
        expand(FOLDER + "/shards/{{shard}}-of-{shards}.done", shard=range(1, SHARDS + 1)),
    output:
        FOLDER + "/runs.csv",
        FOLDER + "/summary.csv",
    shell:
        "{{SWEEP}} --collect || test $? -eq 1"


rule shard:
    input:
        {inputs},
    output:
        touch(FOLDER + "/shards/{{shard}}-of-{shards}.done"),
    threads: {jobs}
    shell:
        "{{SWEEP}} --shard {{wildcards.shard}}/{{SHARDS}} --jobs {{threads}} || test $? -eq 1"
)py",
      fmt::arg("command", python(parts.command)), fmt::arg("folder", python(parts.folder)),
      fmt::arg("shards", parts.shards), fmt::arg("inputs", python(parts.inputs)),
      fmt::arg("jobs", parts.jobs));
}

}  // namespace apothem
