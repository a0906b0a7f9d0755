// Private header: the sub-commands of the program with their options. Each function returns an exit
// code and throws where its command fails; main() in apothem.cpp turns exceptions into exit
// codes.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/meshing/voronoi.hpp"
#include "lib/run/exit_code.hpp"
#include "lib/scene/setting.hpp"

namespace apothem {

/// The error for a command line that asks for something impossible.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& what) : std::runtime_error(what) {}
  /// `where`: the option, or the sub-command.
  UsageError(const std::string& where, const std::string& what)
      : std::runtime_error(where + ": " + what) {}
};

/// Options of `apothem run`.
struct RunOptions {
  std::string scene;   ///< scene file
  std::string folder;  ///< folder of results; empty: out/NAME
  int threads = 1;
  std::optional<double> until;  ///< end of this run instead of the scene's, s
  bool resume = false;          ///< continue from the checkpoint in the folder, or begin
  bool overwrite = false;       ///< replace the results in the folder
  bool quiet = false;
  bool verify = false;
  bool json = false;             ///< print JSON instead of a summary
  bool picture = false;          ///< draw the last frame
  std::vector<std::string> set;  ///< PATH=VALUE, in place of values of the scene
  std::string from;              ///< DIR or DIR@TIME of another run to begin with
};
/// Runs a scene and writes its results.
int run_command(const RunOptions& options);

/// The settings of --set. Throws SceneError, at the scene.
std::vector<Setting> settings_of(const std::vector<std::string>& texts, const std::string& scene);

/// Options of `apothem sweep`.
struct SweepOptions {
  std::string scene;              ///< scene file
  std::vector<std::string> vary;  ///< PATH=A,B,C or PATH=FROM..TO[:STEP]
  std::string table;              ///< CSV file with rows of values; empty: none
  std::vector<std::string> set;   ///< PATH=VALUE, the same for all runs
  std::string from;               ///< DIR or DIR@TIME of another run to begin with
  std::string folder;             ///< folder of the study; empty: out/NAME-sweep
  int jobs = 0;                   ///< runs at a time; 0: one for each core
  std::string shard;              ///< I/N, the part of the runs to do; empty: all
  std::string survival;           ///< MEASURE[:EVENT]; empty: no exponential fit
  std::string workflow;           ///< write a workflow for this tool instead; empty: none
  int shards = 0;                 ///< parts of the workflow; 0: by the number of runs
  bool retry_failed = false;
  bool collect = false;  ///< make the tables of what there is, without running
  bool dry_run = false;  ///< list the runs
  bool quiet = false;
};
/// Does many runs of a scene with varied values and writes their tables.
int sweep_command(const SweepOptions& options);

/// Options of `apothem picture`.
struct PictureOptions {
  std::string folder;          ///< results of a run
  std::string output;          ///< file; empty: picture.png, or PLOT.png, in the folder
  std::optional<double> time;  ///< of the frame, s; empty: the last one
  int strip = 1;               ///< number of frames
  std::string colour;          ///< name of a quantity; empty: chosen by what the run holds
  bool chains = false, roses = false;
  double deformation = 1;            ///< factor of displacements
  std::vector<double> window;        ///< X0, Y0, X1, Y1 in m; empty: all bodies
  std::vector<double> range;         ///< ends of the colour scale; empty: all values
  std::string plot;                  ///< one of kRunPlots instead of frames; empty: none
  std::vector<std::string> columns;  ///< of the plot; empty: all that change
};
/// Draws results of a run.
int picture_command(const PictureOptions& options);

/// Options of `apothem check`.
struct CheckOptions {
  std::string scene;             ///< scene file
  bool json = false;             ///< print JSON instead of a table
  std::vector<std::string> set;  ///< PATH=VALUE, in place of values of the scene
};
/// Validates a scene and prints what a run would do.
int check_command(const CheckOptions& options);

/// Options of `apothem modes`.
struct ModesOptions {
  std::string scene;       ///< scene file
  int count = 10;          ///< of modes besides those at 0 Hz
  bool buckling = false;   ///< buckling loads instead
  std::string folder;      ///< folder of results; empty: none are written
  bool overwrite = false;  ///< replace the results in the folder
  int threads = 1;
  bool json = false;             ///< print JSON instead of a table
  std::vector<std::string> set;  ///< PATH=VALUE, in place of values of the scene
};
/// Finds the modes of vibration of a scene, or its buckling loads.
int modes_command(const ModesOptions& options);

/// Options of `apothem contact`.
struct ContactOptions {
  std::string a, b;   ///< files of the two polygons
  std::string batch;  ///< file with one pair per line, instead of `a` and `b`
  std::string potential = "distance";
  std::optional<std::string> field;  ///< depth field of the distance potential; by default the roof
  /// Reference length of the distance potential; by default the roof's height.
  std::optional<std::string> reference;
  std::string method = "edge";  ///< way to compute the contact
  double stiffness = 1;         ///< normal contact stiffness k_n, Pa
  std::string shapes;           ///< what to write to `output`: "overlap"; empty: nothing
  std::string output;           ///< file of shapes
  bool json = false;            ///< print JSON instead of a table
};
/// Computes the contact of two polygons, or of all pairs in a file.
int contact_command(const ContactOptions& options);

/// Options of `apothem boolean`.
struct BooleanOptions {
  std::string a, b;       ///< files of the two polygons
  std::string operation;  ///< one of kBooleanOperations
  std::string output;     ///< file of shapes; empty: WKT on standard output
  bool json = false;      ///< print the result as JSON
};
/// Writes the union, intersection or difference of two polygons.
int boolean_command(const BooleanOptions& options);

/// Options of `apothem mesh`.
struct MeshOptions {
  std::string file;   ///< file of a region, or of a mesh (.msh)
  bool make = false;  ///< cut the region into Voronoi cells
  VoronoiOptions voronoi;
  std::string output;  ///< file for the cells, by its ending; empty: standard output
  std::string vtk;     ///< file for VTK; empty: none
  bool json = false;   ///< describe a mesh in JSON instead of a table
};
/// Cuts a region into cells, or describes a mesh.
int mesh_command(const MeshOptions& options);

/// Options of `apothem polygon`.
struct PolygonOptions {
  std::string file;                ///< polygon file
  std::string batch;               ///< file with one list of vertices per line, instead of `file`
  std::string reference = "roof";  ///< reference length: a name or a length in m
  std::string vtk;                 ///< folder for VTK files; empty: none
  std::string picture;             ///< file for a picture; empty: none
  std::string shapes;      ///< what to write to `output`, see polygon_output(); empty: nothing
  std::string output;      ///< file of shapes
  std::vector<double> at;  ///< x, y of a point to evaluate, m; empty: none
  std::string points;      ///< CSV file of points to evaluate; empty: none
  bool repair = false;     ///< repair the outlines of the file, and say their faults
  std::optional<double> tolerance;  ///< of the repair, m
  bool json = false;                ///< print JSON instead of a table
};
/// Prints and draws a polygon's properties and its potential.
int polygon_command(const PolygonOptions& options);

/// Options of `apothem accuracy`.
struct AccuracyOptions {
  std::vector<std::string> cases;  ///< files of pairs; empty: the built-in generic and hard pairs
  std::string folder = "out/accuracy";  ///< folder of results
  int repetitions = 1;                  ///< how often times are measured; their range is printed
  /// If not empty: write the hard pairs and their expected contact to this file instead.
  std::string write_cases;
};
/// Compares speed and error of all methods for the contact force.
int accuracy_command(const AccuracyOptions& options);

/// Options of `apothem benchmark`.
struct BenchmarkOptions {
  bool list = false;    ///< list the cases, and end
  std::string filter;   ///< regular expression that names of cases contain; empty: all short ones
  int repetitions = 5;  ///< how often each case is timed
  int threads = 1;
  bool quick = false;   ///< shorter times
  std::string compare;  ///< another program to run alternately with this one; empty: none
  std::string folder;   ///< folder of results; empty: none are written
  bool json = false;    ///< print JSON instead of a table
};
/// Times kernels and scenes.
int benchmark_command(const BenchmarkOptions& options);

/// Options of `apothem reproduce`.
struct ReproduceOptions {
  std::vector<std::string> figures;      ///< names, or "all"; empty: print the list of figures
  std::string folder = "out/reproduce";  ///< folder of results
  std::string data;  ///< folder of figures, scenes and references; empty: the program's own
  int threads = 1;
  bool verify = false;
  bool quick = false;  ///< studies of a few runs
};
/// Runs the scenes of figures and writes their curves, pictures and a report.
int reproduce_command(const ReproduceOptions& options);

/// Options of `apothem view`.
struct ViewOptions {
  std::string folder;          ///< results of a run
  std::string output;          ///< HTML file; empty: view.html in the folder
  std::string movie;           ///< file of a movie, in place of the page; empty: none
  std::string colour;          ///< of the movie; empty: chosen by what the run holds
  bool chains = false;         ///< in the movie
  std::vector<double> window;  ///< of the movie: X0, Y0, X1, Y1 in m; empty: all bodies
  std::vector<double> range;   ///< of the movie: ends of the colour scale; empty: all values
  int rate = 20;               ///< of the movie, frames per second
};
/// Writes a run as a page that plays it, or as a movie.
int view_command(const ViewOptions& options);

/// Options of `apothem completion`.
struct CompletionOptions {
  std::string shell;  ///< bash or zsh
};

}  // namespace apothem
