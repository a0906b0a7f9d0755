// The sub-commands of the program. Each returns an exit code of the public contract.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apothem/geometry/meshing/voronoi.hpp"

namespace apothem {

namespace exit_code {
inline constexpr int done = 0;
inline constexpr int missed = 1;  ///< an expectation of the scene or of a file of pairs was not met
inline constexpr int bad_input = 2;
inline constexpr int unstable = 3;
inline constexpr int system_failed = 4;
inline constexpr int interrupted = 130;
}  // namespace exit_code

struct RunOptions {
  std::string scene;
  std::string folder;  ///< empty: out/NAME
  int threads = 1;
  std::optional<double> until;  ///< s
  bool resume = false;          ///< from the folder's checkpoint
  bool overwrite = false;
  bool quiet = false;
  bool verify = false;
};
int run_command(const RunOptions& options);

struct CheckOptions {
  std::string scene;
};
int check_command(const CheckOptions& options);

struct ContactOptions {
  std::string a, b;
  std::string batch;  ///< file of pairs instead of a and b
  std::string potential = "distance";
  std::optional<std::string> field;      ///< distance potential only; by default its roof
  std::optional<std::string> reference;  ///< distance potential only; by default the roof's height
  std::string method = "edge";
  double stiffness = 1;
  bool json = false;
};
int contact_command(const ContactOptions& options);

struct MeshOptions {
  std::string file;   ///< a region, or a mesh (.msh)
  bool make = false;  ///< Voronoi cells in the region
  VoronoiOptions voronoi;
  std::string output;  ///< empty: a region's cells go to standard output
  std::string vtk;     ///< empty: none
  bool json = false;   ///< the description of a mesh
};
int mesh_command(const MeshOptions& options);

struct PolygonOptions {
  std::string file;
  std::string batch;  ///< file of rings instead of one polygon
  std::string reference = "roof";
  std::string vtk;      ///< folder
  std::string picture;  ///< file
  bool json = false;
};
int polygon_command(const PolygonOptions& options);

struct AccuracyOptions {
  std::vector<std::string> cases;  ///< files of pairs; none: generic and hard pairs
  std::string folder = "out/accuracy";
  std::string write_cases;  ///< write the hard pairs with expected values there instead
};
int accuracy_command(const AccuracyOptions& options);

struct ReproduceOptions {
  std::vector<std::string> figures;  ///< names, or "all"; none: print the list
  std::string folder = "out/reproduce";
  std::string data;  ///< folder with figures, scenes and reference; empty: the program's own
  int threads = 1;
  bool verify = false;
};
int reproduce_command(const ReproduceOptions& options);

}  // namespace apothem
