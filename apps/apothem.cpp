// The program's command line: options of all sub-commands, and the exit code and message of each
// kind of failure.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <new>

#include "apothem/output/files.hpp"
#include "apothem/scene/error.hpp"
#include "commands.hpp"
#include "version.hpp"
#include "work_line.hpp"

namespace {

using namespace apothem;

// CLI11's own PositiveNumber accepts nan and inf.
const CLI::Validator kPositive(
    [](std::string& text) {
      char* end = nullptr;
      const double x = std::strtod(text.c_str(), &end);
      return x > 0 && std::isfinite(x) && *end == '\0' ? std::string()
                                                       : "must be a positive number, not " + text;
    },
    "POSITIVE");

void add_threads(CLI::App* sub, int& threads) {
  sub->add_option("--threads", threads, "Threads of the contact phase")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void add_run(CLI::App& app, RunOptions& o) {
  CLI::App* sub = app.add_subcommand("run", "Run a scene");
  sub->add_option("SCENE", o.scene, "Scene file (JSON)")->required();
  sub->add_option("-o,--output", o.folder, "Output folder (default: out/NAME)");
  add_threads(sub, o.threads);
  sub->add_option("--until", o.until, "Stop at this time in s instead of the scene's end")
      ->check(kPositive);
  CLI::Option* resume =
      sub->add_flag("--resume", o.resume, "Continue from the checkpoint in the output folder");
  sub->add_flag("--overwrite", o.overwrite, "Replace the results in the output folder")
      ->excludes(resume);
  sub->add_flag("--quiet", o.quiet, "No progress and no summary");
  sub->add_flag("--verify", o.verify, "Exit with 1 if an expectation of the scene is not met");
}

void add_check(CLI::App& app, CheckOptions& o) {
  CLI::App* sub = app.add_subcommand("check", "Validate a scene and print what a run would do");
  sub->add_option("SCENE", o.scene, "Scene file (JSON)")->required();
}

void add_contact(CLI::App& app, ContactOptions& o) {
  CLI::App* sub = app.add_subcommand("contact", "Contact force of two polygons");
  CLI::Option* a = sub->add_option("A", o.a, "Polygon: WKT, [[x,y],...] or {\"polygon\": ...}");
  CLI::Option* b = sub->add_option("B", o.b, "The other polygon");
  a->needs(b);
  sub->add_option("--batch", o.batch, "File with one pair per line: name n x y ... m x y ...")
      ->excludes(a)
      ->excludes(b);
  sub->add_option("--potential", o.potential, "Contact potential")
      ->check(CLI::IsMember({"distance", "area"}))
      ->capture_default_str();
  sub->add_option("--field", o.field, "Depth in polygons that are not convex (default: roof)")
      ->check(CLI::IsMember({"roof", "distance"}));
  sub->add_option("--reference", o.reference, "roof (default), inscribed_circle or a length in m");
  sub->add_option("--method", o.method, "Way to the numbers")
      ->check(CLI::IsMember({"edge", "overlap", "exact", "all"}))
      ->capture_default_str();
  sub->add_option("--stiffness", o.stiffness, "Normal stiffness k_n in Pa")
      ->check(kPositive)
      ->capture_default_str();
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_mesh(CLI::App& app, MeshOptions& o) {
  CLI::App* sub = app.add_subcommand(
      "mesh", "Mesh a region with polygonal cells, or describe a mesh of gmsh's");
  sub->add_option("FILE", o.file,
                  "Region: WKT, [[x,y],...] or {\"polygon\": ...}; or a mesh: NAME.msh")
      ->required();
  CLI::Option* cells = sub->add_option("--voronoi", o.voronoi.cells, "Number of Voronoi cells");
  sub->add_option("--seed", o.voronoi.seed, "Of the random sites")
      ->check(CLI::NonNegativeNumber)
      ->needs(cells)
      ->capture_default_str();
  sub->add_option("--lloyd", o.voronoi.lloyd, "Steps of Lloyd's iteration, at most")
      ->needs(cells)
      ->capture_default_str();
  sub->add_option("--shortest-edge", o.voronoi.shortest_edge,
                  "Collapse shorter edges; 0 to 0.5, of the mean cell size sqrt(area / cells)")
      ->needs(cells)
      ->capture_default_str();
  sub->add_flag("--json", o.json, "Print the description of a mesh as JSON")->excludes(cells);
  sub->add_option("-o,--output", o.output,
                  "JSON file (default: standard output for Voronoi cells, none for a mesh)");
  sub->add_option("--vtk", o.vtk, "VTK file (.vtu) to look at");
  sub->final_callback([&o, cells] { o.make = cells->count() > 0; });
}

void add_polygon(CLI::App& app, PolygonOptions& o) {
  CLI::App* sub = app.add_subcommand("polygon", "A polygon's roof, singular area and circles");
  CLI::Option* file =
      sub->add_option("FILE", o.file, "Polygon: WKT, [[x,y],...] or {\"polygon\": ...}");
  CLI::Option* batch =
      sub->add_option("--batch", o.batch, "File with one ring per line: name n x y ...")
          ->excludes(file);
  sub->add_option("--reference", o.reference, "roof, inscribed_circle or a length in m")
      ->capture_default_str();
  sub->add_option("--vtk", o.vtk, "Folder for faces.vtu and singular_area.vtu")->excludes(batch);
  sub->add_option("--picture", o.picture, "Picture of the potential, .png or .svg")
      ->excludes(batch);
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_accuracy(CLI::App& app, AccuracyOptions& o) {
  CLI::App* sub = app.add_subcommand("accuracy", "Speed against error of the contact methods");
  CLI::Option* cases = sub->add_option(
      "--cases", o.cases, "Files of pairs (JSON, or lines as of contact --batch) instead of ours");
  sub->add_option("-o,--output", o.folder, "Output folder")->capture_default_str();
  sub->add_option("--write-cases", o.write_cases,
                  "Write our hard pairs with expected values to this file, and end")
      ->excludes(cases);
}

void add_reproduce(CLI::App& app, ReproduceOptions& o) {
  CLI::App* sub = app.add_subcommand("reproduce", "The paper's figures: runs, curves and a report");
  sub->add_option("LIST", o.figures, "Names of figures, or all; nothing lists them")
      ->delimiter(',');
  sub->add_option("-o,--output", o.folder, "Output folder")->capture_default_str();
  sub->add_option("--data", o.data, "Folder with figures, scenes and reference (default: ours)");
  add_threads(sub, o.threads);
  sub->add_flag("--verify", o.verify, "Exit with 1 if a number misses its tolerance");
}

int fail(int code, const char* what) {
  fmt::print(stderr, "apothem: {}\n", what);
  return code;
}

int run(int argc, char** argv) {
  CLI::App app{"Apothem: distance-potential finite-discrete element method in 2-D", "apothem"};
  app.set_version_flag("--version", std::string("apothem ") + kVersion);
  app.require_subcommand(1);
  RunOptions run_options;
  CheckOptions check_options;
  ContactOptions contact_options;
  PolygonOptions polygon_options;
  MeshOptions mesh_options;
  add_run(app, run_options);
  add_check(app, check_options);
  add_contact(app, contact_options);
  AccuracyOptions accuracy_options;
  add_polygon(app, polygon_options);
  add_mesh(app, mesh_options);
  add_accuracy(app, accuracy_options);
  ReproduceOptions reproduce_options;
  add_reproduce(app, reproduce_options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // after --help or --version
    fmt::print(stderr, "apothem: {}; see apothem --help\n", error.what());
    return exit_code::bad_input;
  }
  if (app.got_subcommand("run")) return run_command(run_options);
  if (app.got_subcommand("check")) return check_command(check_options);
  if (app.got_subcommand("mesh")) return mesh_command(mesh_options);
  if (app.got_subcommand("polygon")) return polygon_command(polygon_options);
  if (app.got_subcommand("accuracy")) return accuracy_command(accuracy_options);
  if (app.got_subcommand("reproduce")) return reproduce_command(reproduce_options);
  return contact_command(contact_options);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a limit on file sizes becomes an error of write()
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return fail(apothem::exit_code::system_failed, "standard output cannot be written");
    }
    return code;
  } catch (const apothem::SceneError& error) {
    return fail(apothem::exit_code::bad_input, error.what());
  } catch (const apothem::Interrupted& interrupt) {
    return fail(apothem::exit_code::interrupted, interrupt.what());
  } catch (const apothem::SystemFailure& error) {
    return fail(apothem::exit_code::system_failed, error.what());
  } catch (const std::bad_alloc&) {
    return fail(apothem::exit_code::system_failed, "out of memory");
  } catch (const std::exception& error) {
    // Other failures of the system, like a full pipe or a file name that it refuses.
    return fail(apothem::exit_code::system_failed, error.what());
  }
}
