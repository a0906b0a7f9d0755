// run.json: what a run was and how it went.
#pragma once

#include <string>

namespace apothem {

class Run;
struct LoadStep;

/// The text of run.json.
std::string summary_text(const Run& run);
/// Throws SystemFailure.
void write_summary(const Run& run);

/// Size of the sum of all forces on a deformable body over the sum of the sizes of all loads.
double imbalance_of_load(const LoadStep& step, size_t body);

}  // namespace apothem
