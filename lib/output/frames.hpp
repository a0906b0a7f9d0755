// Writes the time series of a run, for ParaView, in one of two formats. The first has a .vtu file
// for each frame and series, and lists of them: frames.pvd for the bodies, outlines.pvd for the
// lines around them, contacts.pvd for the contact patches, chains.pvd for the lines along which
// they carry force, roses.pvd for the directions of contacts in regions, and surfaces.pvd for the
// boundaries of bodies that are in contact with meshes. names.csv has the names of what frames
// number. Bodies that are not there are left out. VTK, ParaView, PyVista and meshio read all of
// these files. The second is a container of all frames in three files, see frame_container.hpp.
//
// Cells are convex, because many viewers fill a polygon as if it were. A body or an element that is
// not convex is several cells with the same values, numbered by the cell data `part`.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lib/execution/parallel.hpp"
#include "lib/mesh/mesh.hpp"
#include "lib/model/frame_format.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"
#include "lib/model/statistics.hpp"
#include "lib/output/file_list.hpp"

namespace apothem {

class FrameContainer;

/// What a frame shows.
struct FrameContents {
  const State& state;
  std::vector<ContactRecord> contacts = {};
  /// One for each element of all deformable bodies, in the order of the model.
  std::vector<CauchyStress> stresses = {};
  std::vector<SurfaceRecord> surfaces = {};
  std::vector<BodyForce> forces = {};       ///< contact force on each body, rigid ones first
  std::vector<double> node_mass = {};       ///< kg
  std::vector<BodyStatistics> bodies = {};  ///< of all bodies
};

/// Cells as lists of their corners, or lines as lists of their points.
using Cells = std::vector<std::vector<int>>;

/// What frames of bodies have in common, whatever their state.
struct BodyShapes {
  std::map<RigidIndex, Cells> cells;  ///< of each rigid body that is not convex, by its corners
  std::vector<Cells> loops;           ///< around each mesh, by its nodes
};

/// Writes the time series of a run into a folder of results.
class FrameWriter {
 public:
  /// Creates the folder. `times` (s) are those of the frames that it already contains, if a run is
  /// continued. `list`: gets the names of the files; null: none. Model and list must outlive the
  /// writer. Throws SystemFailure.
  FrameWriter(std::string folder, const Model& model, std::vector<double> times = {},
              int threads = 1, FileList* list = nullptr, FrameFormat format = FrameFormat::vtu);
  ~FrameWriter();
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  /// Writes the next frame and then the lists, so that every file that these list is complete.
  /// Threads make files of the frame at the same time. Throws SystemFailure; the earlier frames are
  /// then intact.
  void write(const FrameContents& frame);

  /// Sees to it that all frames outlast a machine that stops. Throws SystemFailure.
  void make_last();

  /// Times of all frames so far, s.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }

 private:
  void write_files(const FrameContents& frame);
  void contain(const FrameContents& frame);

  std::string folder_;
  const Model& model_;
  Threads threads_;
  BodyShapes shapes_;
  std::vector<double> times_;
  std::vector<std::string> lists_;  // the .pvd files without their ends
  FileList* list_;
  std::vector<std::string> fresh_;             // files since the last call of make_last()
  std::unique_ptr<FrameContainer> container_;  // of its format; else null
};

/// The names of the lists of all series that frames may have, and of the files of containers.
std::vector<std::string> frame_lists();

/// Whether frames have files of this name, relative to the folder of results.
bool is_frame_file(const std::string& name);

}  // namespace apothem
