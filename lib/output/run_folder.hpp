// Reads the folder of a run back: the bodies of its frames, contact forces and histories. A run
// that was interrupted, or that still goes on, can be read too: the .pvd files list complete frames
// only.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"
#include "lib/mesh/mesh.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"
#include "lib/output/history.hpp"

namespace apothem {

class ContainedFrames;
struct GridFile;

/// Thrown for results that are missing or cannot be read. The message names the file and the
/// remedy.
class ResultsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A body in a frame.
struct FrameBody {
  std::string name;
  bool present = false;  ///< bodies may come and go
  bool meshed = false;   ///< of finite elements; otherwise it is rigid
  Motion motion = Motion::free;
  /// Of kBodyQuantities, in that order. What frames do not have is zero, and NaN if these were
  /// written before there was such a quantity.
  std::array<Components, kBodyQuantities.size()> values{};

  [[nodiscard]] double rotation() const { return values[body_quantity("rotation")][0]; }
  [[nodiscard]] double spin() const { return values[body_quantity("spin")][0]; }
  [[nodiscard]] CauchyStress mean_stress() const {
    const auto& [xx, yy, xy] = values[body_quantity("mean_stress")];
    return {xx, yy, xy, 0, 0};
  }
};

/// The holes of those elements that have any: rings of nodes, clockwise.
using ElementHoles = std::map<int, std::vector<std::vector<int>>>;

/// The outer ring of an element and its holes, where its nodes have these places.
Rings rings_of(std::span<const Vec2> places, std::span<const int> element,
               const ElementHoles& holes, int number);

/// The bodies in one frame: a mesh in which each rigid body is one element, and each finite element
/// of a meshed body another one.
struct Frame {
  double time = 0;                 ///< s
  Mesh mesh;                       ///< configuration before the run, m
  ElementHoles holes;              ///< of rigid bodies
  std::vector<Vec2> position;      ///< of each node in the frame, m, to the bit as written
  std::vector<Vec2> displacement;  ///< of each node, m
  std::vector<Vec2> velocity;      ///< of each node, m/s
  /// Stress of each element, Pa, without energy density; zero for rigid bodies.
  std::vector<CauchyStress> stress;
  std::vector<int> body;          ///< body of each element; rigid bodies come first
  std::vector<int> material;      ///< of each element
  std::vector<FrameBody> bodies;  ///< all bodies of the scene, also those that are not there
  std::vector<std::string> material_names;

  /// The body of an element.
  [[nodiscard]] const FrameBody& body_of(int element) const { return bodies[body[element]]; }
};

/// Whether no body of the scene is of finite elements.
bool all_rigid(const Frame& frame);

/// A line along which a contact patch carries force: from the mass centre of each body that is free
/// to the loading point.
struct ForceChain {
  int body_a = 0, body_b = 0;
  std::vector<Vec2> line;  ///< m
  double normal = 0;       ///< size of the normal force, N
};

/// A closed line around the middle of a region, farther away in directions that more contact
/// normals have.
struct Rose {
  std::vector<Vec2> line;         ///< m
  std::vector<double> frequency;  ///< of each point of the line, over the mean of all directions
};

/// The name of a folder without the path to it, as a title of what is in it.
std::string folder_title(const std::string& folder);

/// One of kHistoryFiles in a folder of results. Throws ResultsError.
HistoryTable read_table(const std::string& folder, const std::string& file);

/// The names of what frames number.
struct FrameNames {
  std::vector<std::string> bodies, materials;
  size_t rigid_bodies = 0;  ///< which come first among the bodies
};

/// Reads names.csv of a folder of results: rows with a kind (rigid_body, deformable_body or
/// material), a number and a name. Throws ResultsError.
FrameNames read_names(const std::string& file);

/// The results of a run. All functions throw ResultsError.
class RunFolder {
 public:
  /// Reads the list of frames, which must not be empty.
  explicit RunFolder(std::string folder);

  [[nodiscard]] const std::string& path() const { return folder_; }
  /// Times of the frames, s.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// The frame whose time is nearest to `time` (s), which must lie within those of the frames.
  [[nodiscard]] size_t nearest(double time) const;

  [[nodiscard]] Frame frame(size_t number) const;
  [[nodiscard]] std::vector<ForceChain> chains(size_t number) const;
  /// The pressure and traction on the boundaries of bodies in contact with meshes.
  [[nodiscard]] std::vector<SurfaceRecord> surfaces(size_t number) const;
  /// Whether the scene has regions, which have roses.
  [[nodiscard]] bool has_roses() const;
  [[nodiscard]] std::vector<Rose> roses(size_t number) const;

  /// Whether a file of that name is in the folder.
  [[nodiscard]] bool has(const std::string& file) const;
  /// One of kHistoryFiles.
  [[nodiscard]] HistoryTable table(const std::string& file) const {
    return read_table(folder_, file);
  }

 private:
  [[nodiscard]] GridFile grid(const char* series, size_t number) const;

  std::string folder_;
  FrameNames names_;
  std::vector<double> times_;
  std::vector<std::string> files_;  // of the bodies in each frame, relative to the folder
  std::shared_ptr<const ContainedFrames> container_;  // in place of such files; null: none
};

/// The first frame not before `time` and not after `latest` (s) in a folder of results. Throws
/// ResultsError if there is none or if it cannot be read.
Frame read_frame(const std::string& folder, double time, double latest);

/// The pressure and traction on the boundaries of bodies in contact with meshes, in the frame that
/// read_frame would read. Throws as read_frame does.
std::vector<SurfaceRecord> read_surfaces(const std::string& folder, double time, double latest);

}  // namespace apothem
