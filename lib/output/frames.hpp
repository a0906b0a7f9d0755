// The VTK time series: frames.pvd with one .vtu per frame for the bodies, contacts.pvd for the
// contact patches, surfaces.pvd for the boundaries of bodies in contact with meshes. A mesh as a
// .vtu of its own. All open in ParaView.
#pragma once

#include <string>
#include <vector>

#include "geometry/polygon_mesh.hpp"
#include "mesh/mesh.hpp"
#include "model/model.hpp"
#include "model/state.hpp"

namespace apothem {

class FrameWriter {
 public:
  /// Creates the folder; frames at `times` are there already. Throws SystemFailure.
  FrameWriter(std::string folder, const Model& model, std::vector<double> times = {});

  /// `stresses` of the elements of all deformable bodies, in their order.
  /// Writes the next frame, then both collections: whatever they list is complete on disk.
  /// Throws SystemFailure; the earlier frames are then intact.
  void write(const State& state, const std::vector<ContactRecord>& contacts,
             const std::vector<CauchyStress>& stresses, const std::vector<SurfaceRecord>& surfaces);

  [[nodiscard]] const std::vector<double>& times() const { return times_; }

 private:
  std::string folder_;
  const Model& model_;
  std::vector<double> times_;
};

/// Bodies as a frame shows them: a rigid one is a cell of its own, and so is an element.
struct Frame {
  double time = 0;                   ///< s
  Mesh mesh;                         ///< where it was before the run, m
  std::vector<Vec2> displacement;    ///< of the nodes, m
  std::vector<Vec2> velocity;        ///< m/s
  std::vector<CauchyStress> stress;  ///< of the cells, without energy; of rigid bodies zero
  std::vector<int> body;             ///< of the cells; rigid ones first
};

/// The first frame at or after `time`, but not later than `latest`, in a folder of results. Throws
/// std::runtime_error if there is none, or if it cannot be read.
Frame read_frame(const std::string& folder, double time, double latest);

/// The same for the boundaries of bodies in contact with meshes.
std::vector<SurfaceRecord> read_surfaces(const std::string& folder, double time, double latest);

/// The cells as polygons with shared points; cell data: cell (index), area in m^2. Throws
/// SystemFailure.
void write_mesh(const std::string& file, const PolygonMesh& mesh);

}  // namespace apothem
