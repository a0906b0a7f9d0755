#include "lib/run/cost.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/system/memory.hpp"

namespace apothem {
namespace {

// Measured on piles and meshes: a frame and what it adds for each vertex or node.
struct FrameCost {
  double bytes, point_bytes;
  double seconds, point_seconds;
};
constexpr FrameCost kOfFiles{8e3, 150, 1e-3, 2e-6}, kOfContainer{12e3, 120, 1e-4, 3e-7};
constexpr double kNumberBytes = 19, kNumberSeconds = 1e-7;     // of a history
constexpr double kRowSeconds = 5e-6, kRowPointSeconds = 2e-8;  // sums that are made for it
constexpr double kLedgers = 17;  // columns of energy.csv, momentum.csv

constexpr double kMostFiles = 1e5, kMostBytes = 2e10, kMostSeconds = 86400;
constexpr double kMostMemory = .5;  // of what there is

double points_of(const Model& model) {
  double points = static_cast<double>(model.node_count());
  for (const RigidBody& body : model.bodies) points += body.potential.size();
  return points;
}

double columns_of(const OutputSettings& output, const Model& model) {
  constexpr double kOfBody = 9, kOfPoint = 7, kOfRegion = 11;
  return kLedgers +
         kOfBody * static_cast<double>(output.track.size() + output.track_deformables.size()) +
         kOfPoint * static_cast<double>(output.points.size()) +
         kOfRegion * static_cast<double>(model.regions.size());
}

std::string duration(double seconds) {
  return seconds < 2 * 86400. ? fmt::format("{:.2g} h", seconds / 3600)
                              : fmt::format("{:.2g} days", seconds / 86400);
}

}  // namespace

OutputCost output_cost(const Scene& scene, double steps) {
  const OutputSettings& output = scene.output;
  const double rows_wanted = scene.time.statics ? steps : scene.time.end / output.history_interval;
  const double rows = 1 + std::min(rows_wanted, steps);
  OutputCost cost;
  cost.frames = 1 + (scene.time.statics ? steps : std::min<double>(output.frames, steps));
  const double series =
      4 + (scene.model.deformables.empty() ? 0. : 1.) + (scene.model.regions.empty() ? 0. : 1.);
  const double points = points_of(scene.model), numbers = rows * columns_of(output, scene.model);
  const bool contained = scene.frame_format == FrameFormat::xdmf;
  const FrameCost& each = contained ? kOfContainer : kOfFiles;
  cost.files = contained ? 3 : series * cost.frames;
  cost.bytes = cost.frames * (each.bytes + each.point_bytes * points) + kNumberBytes * numbers;
  cost.seconds = cost.frames * (each.seconds + each.point_seconds * points) +
                 rows * (kRowSeconds + kRowPointSeconds * points) + kNumberSeconds * numbers;
  return cost;
}

std::vector<std::string> excessive_costs(const Scene& scene, double steps) {
  std::vector<std::string> sentences;
  const OutputCost cost = output_cost(scene, steps);
  if (cost.files > kMostFiles || cost.bytes > kMostBytes || cost.seconds > kMostSeconds) {
    sentences.push_back(fmt::format(
        "{}: the results take about {:.2g} files, {:.2g} GB of disk and {} to write: {:.4g} "
        "frames; check \"frames\" and \"history\" in \"output\"{}",
        scene.file, cost.files, cost.bytes / 1e9, duration(cost.seconds), cost.frames,
        scene.time.statics ? ", and \"load_steps\" in \"time\"" : ""));
  }
  const double used = memory_used(), there = memory_limit();
  if (used > kMostMemory * there) {
    sentences.push_back(fmt::format(
        "{}: its bodies take {:.2g} GB of memory, and there are {:.2g} GB; check counts of bodies, "
        "\"repeat\" of fills, and sizes of elements",
        scene.file, used / 1e9, there / 1e9));
  }
  return sentences;
}

}  // namespace apothem
