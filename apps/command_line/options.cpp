#include "apps/command_line/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "geometry/regions/boolean.hpp"
#include "lib/output/field.hpp"
#include "lib/output/run_plot.hpp"
#include "lib/output/shape_file.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/words.hpp"
#include "version.hpp"

namespace apothem {
namespace {

// CLI11's own PositiveNumber accepts nan, inf and hexadecimal numbers.
const CLI::Validator kPositive(
    [](std::string& text) {
      return find_decimal(text).value_or(0) > 0 ? std::string()
                                                : "must be a positive number, not " + text;
    },
    "POSITIVE");

// CLI11 itself reads 010 as eight, and hexadecimal numbers.
const CLI::Validator kWhole(
    [](std::string& text) {
      if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos) {
        return "must be a whole number, not " + text;
      }
      text.erase(0, std::min(text.find_first_not_of('0'), text.size() - 1));
      return std::string();
    },
    "");

const CLI::Validator kDecimal(
    [](std::string& text) {
      try {
        parse_decimal(text);
      } catch (const BadNumber& error) {
        return std::string(error.what());
      }
      return std::string();
    },
    "");

// An option whose value the help calls `type`.
template <class T>
CLI::Option* add(CLI::App* sub, const char* names, T& value, const char* type, const char* about) {
  return sub->add_option(names, value, about)->type_name(type);
}

// An option that takes a whole number from 1 to `most`.
CLI::Option* add_whole(CLI::App* sub, const char* names, int& value, int most, const char* about) {
  return add(sub, names, value, "N", about)->transform(kWhole)->check(CLI::Range(1, most));
}

void add_threads(CLI::App* sub, int& threads, const char* about = "Threads of the run") {
  sub->add_option("--threads", threads, about)
      ->transform(kWhole)
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void add_settings(CLI::App* sub, std::vector<std::string>& settings) {
  add(sub, "--set", settings, "PATH=VALUE",
      "PATH=VALUE in place of a value of the scene, again and again; like "
      "contact.friction.coefficient=0.3 or bodies.block.velocity=[0,-1]")
      ->allow_extra_args(false);
}

void add_run(CLI::App& app, RunOptions& o) {
  CLI::App* sub = app.add_subcommand("run", "Run a scene");
  add(sub, "SCENE", o.scene, "FILE", "Scene file (JSON)")->required();
  add(sub, "-o,--output", o.folder, "DIR", "Output folder (default: out/NAME)");
  add_threads(sub, o.threads);
  sub->add_option("--until", o.until, "Stop at this time in s instead of the scene's end")
      ->check(kPositive);
  CLI::Option* resume =
      sub->add_flag("--resume", o.resume,
                    "Continue from the checkpoint in the output folder, or begin if there is "
                    "nothing yet");
  add(sub, "--from", o.from, "DIR[@TIME]",
      "Begin with the last state of the run in this folder, at this time in s if given: "
      "of bodies of the same name and shape");
  add_settings(sub, o.set);
  sub->add_flag("--overwrite", o.overwrite, "Replace the results in the output folder")
      ->excludes(resume);
  sub->add_flag("--picture", o.picture,
                "Draw the end of the run: picture.png in the output folder");
  sub->add_flag("--quiet", o.quiet, "No progress and no summary");
  sub->add_flag("--json", o.json,
                "Print what run.json holds, and the folder, instead of a summary");
  sub->add_flag("--verify", o.verify, "Exit with 1 if an expectation of the scene is not met");
}

CLI::Option* add_window(CLI::App* sub, std::vector<double>& window) {
  return add(sub, "--window", window, "X0,Y0,X1,Y1",
             "Corners of the visible region, m (default: all bodies)")
      ->delimiter(',')
      ->check(kDecimal)
      ->expected(4);
}

CLI::Option* add_range(CLI::App* sub, std::vector<double>& range) {
  return add(sub, "--range", range, "LOW,HIGH",
             "Ends of the colour scale, SI units (default: all values)")
      ->delimiter(',')
      ->check(kDecimal)
      ->expected(2);
}

void add_picture(CLI::App& app, PictureOptions& o) {
  CLI::App* sub = app.add_subcommand("picture", "Draw the results of a run");
  add(sub, "DIR", o.folder, "DIR", "Folder of the results")->required();
  add(sub, "-o,--output", o.output, "FILE",
      "Picture, .png or .svg (default: picture.png, or PLOT.png, in DIR)");
  CLI::Option* time =
      sub->add_option("--time", o.time, "Frame nearest to this time in s (default: the last one)")
          ->check(kDecimal);
  CLI::Option* frames =
      add_whole(sub, "--strip", o.strip, 100, "So many frames, from the first to the last one")
          ->excludes(time);
  CLI::Option* colour =
      sub->add_option("--colour", o.colour,
                      "Quantity that colours the bodies (default: von_mises if there are bodies of "
                      "finite elements, otherwise speed, or material with --chains)")
          ->check(CLI::IsMember(names_of(field_quantities())));
  CLI::Option* chains =
      sub->add_flag("--chains", o.chains, "Contact forces as lines, as wide as the force");
  CLI::Option* roses =
      sub->add_flag("--roses", o.roses, "Directions of contacts in each region of the scene");
  CLI::Option* deformation = add(sub, "--deformation", o.deformation, "FACTOR",
                                 "Factor of all displacements and rotations since the start")
                                 ->check(kDecimal)
                                 ->excludes(chains)
                                 ->excludes(roses);
  CLI::Option* window = add_window(sub, o.window);
  CLI::Option* range = add_range(sub, o.range);
  CLI::Option* plot =
      sub->add_option("--plot", o.plot,
                      "A plot over time instead: energy or momentum, history of bodies and points, "
                      "or regions")
          ->check(CLI::IsMember(std::vector<std::string>(kRunPlots.begin(), kRunPlots.end())));
  for (CLI::Option* of_frames : {time, frames, colour, chains, roses, deformation, window, range}) {
    plot->excludes(of_frames);
  }
  add(sub, "--columns", o.columns, "A,B,C",
      "Columns to plot: NAME.quantity, or quantity for all names (default: all that "
      "change)")
      ->delimiter(',')
      ->needs(plot);
}

void add_sweep(CLI::App& app, SweepOptions& o) {
  CLI::App* sub = app.add_subcommand("sweep", "Run a scene many times with varied values");
  add(sub, "SCENE", o.scene, "FILE", "Scene file (JSON)")->required();
  add(sub, "--vary", o.vary, "PATH=VALUES",
      "Values of a path of the scene, again and again: PATH=A,B,C or "
      "PATH=FROM..TO[:STEP], like contact.friction.coefficient=0.1..0.5:0.1. All "
      "combinations are run; a path that ends in seed repeats them")
      ->allow_extra_args(false);
  add(sub, "--table", o.table, "FILE", "Values that go together: CSV, the first line names paths");
  add_settings(sub, o.set);
  add(sub, "--from", o.from, "DIR[@TIME]",
      "Begin all runs with the state of the run in this folder, "
      "or each with the fitting run of the study in it");
  add(sub, "-o,--output", o.folder, "DIR", "Output folder (default: out/NAME-sweep)");
  add_whole(sub, "--jobs", o.jobs, 4096, "Runs at a time (default: one for each core)");
  CLI::Option* shard =
      add(sub, "--shard", o.shard, "I/N", "Part I of N of the runs only, I from 1");
  sub->add_flag("--retry-failed", o.retry_failed, "Repeat the runs that have failed");
  add(sub, "--survival", o.survival, "MEASURE[:EVENT]",
      "Exponential fit of a number measure, the exposure until an event; EVENT is the "
      "yes/no measure that says whether it has happened (default: always)");
  CLI::Option* collect =
      sub->add_flag("--collect", o.collect, "Make the tables of what there is; run nothing")
          ->excludes(shard);
  CLI::Option* workflow =
      sub->add_option("--workflow", o.workflow, "Write a workflow for this tool; run nothing")
          ->check(CLI::IsMember({"snakemake"}))
          ->excludes(shard)
          ->excludes(collect);
  add_whole(sub, "--shards", o.shards, 100000,
            "Parts of the workflow (default: by the number of runs)")
      ->needs(workflow);
  sub->add_flag("--dry-run", o.dry_run, "List the runs and what there is of them; run nothing")
      ->excludes(collect)
      ->excludes(workflow);
  sub->add_flag("--quiet", o.quiet, "No progress and no summary");
}

void add_check(CLI::App& app, CheckOptions& o) {
  CLI::App* sub = app.add_subcommand("check", "Validate a scene and print what a run would do");
  add(sub, "SCENE", o.scene, "FILE", "Scene file (JSON)")->required();
  add_settings(sub, o.set);
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_modes(CLI::App& app, ModesOptions& o) {
  CLI::App* sub = app.add_subcommand("modes", "Frequencies and shapes of small vibrations");
  add(sub, "SCENE", o.scene, "FILE", "Scene file (JSON)")->required();
  add_whole(sub, "-n,--number", o.count, 1000, "Modes to find, besides those at 0 Hz")
      ->capture_default_str();
  sub->add_flag("--buckling", o.buckling,
                "Factors of the loads of a static scene at which it buckles, instead");
  add(sub, "-o,--output", o.folder, "DIR", "Folder for a table and for frames of the modes");
  sub->add_flag("--overwrite", o.overwrite, "Replace the results in the output folder");
  add_threads(sub, o.threads, "Threads for contacts, elements and frames");
  add_settings(sub, o.set);
  sub->add_flag("--json", o.json, "Print JSON");
}

// --output WHAT -o FILE, which go together. Returns the former.
CLI::Option* add_shapes(CLI::App* sub, std::string& what, const std::vector<std::string>& choices,
                        std::string& file) {
  CLI::Option* shapes = sub->add_option("--output", what, "What to write to the file of -o")
                            ->check(CLI::IsMember(choices));
  CLI::Option* output =
      sub->add_option("-o", file, std::string("File for what --output says: ") + kShapeFormats)
          ->type_name("FILE")
          ->needs(shapes);
  return shapes->needs(output);
}

void add_contact(CLI::App& app, ContactOptions& o) {
  CLI::App* sub = app.add_subcommand("contact", "Contact force of two polygons");
  CLI::Option* a =
      add(sub, "A", o.a, "FILE", "Polygon: WKT, GeoJSON, [[x,y],...] or {\"polygon\": ...}");
  CLI::Option* b = add(sub, "B", o.b, "FILE", "The other polygon");
  a->needs(b);
  CLI::Option* batch =
      sub->add_option(
             "--batch", o.batch,
             "File with one pair per line: name n x y ... m x y ..., or POLYGON ((x y, ...))")
          ->type_name("FILE")
          ->excludes(a)
          ->excludes(b);
  sub->add_option("--potential", o.potential, "Contact potential")
      ->check(CLI::IsMember({"distance", "area"}))
      ->capture_default_str();
  sub->add_option("--field", o.field, "Depth in polygons that are not convex (default: roof)")
      ->check(CLI::IsMember({"roof", "distance"}));
  add(sub, "--reference", o.reference, "REFERENCE",
      "roof (default), inscribed_circle or a length in m");
  sub->add_option("--method", o.method, "Way to the numbers")
      ->check(CLI::IsMember({"edge", "overlap", "exact", "all"}))
      ->capture_default_str();
  sub->add_option("--normal-stiffness,--stiffness", o.stiffness, "Normal stiffness k_n in Pa")
      ->check(kPositive)
      ->capture_default_str();
  add_shapes(sub, o.shapes, {"overlap"}, o.output)->needs(a)->excludes(batch);
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_boolean(CLI::App& app, BooleanOptions& o) {
  CLI::App* sub =
      app.add_subcommand("boolean", "Union, intersection or difference of two polygons");
  sub->add_option("A", o.a, "Polygon: WKT, GeoJSON, [[x,y],...] or {\"polygon\": ...}")
      ->type_name("FILE")
      ->required();
  sub->add_option("B", o.b, "The other polygon")->type_name("FILE")->required();
  std::vector<std::string> names;
  names.reserve(std::size(kBooleanOperations));
  for (const NamedOperation& known : kBooleanOperations) names.emplace_back(known.name);
  sub->add_option("OPERATION", o.operation, "What to make of them; difference: A without B")
      ->check(CLI::IsMember(names))
      ->required();
  sub->add_option("-o", o.output,
                  std::string("File for the result: ") + kShapeFormats +
                      " (default: WKT on standard output)")
      ->type_name("FILE");
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_mesh(CLI::App& app, MeshOptions& o) {
  CLI::App* sub = app.add_subcommand(
      "mesh", "Mesh a region with polygonal cells, or describe a mesh of gmsh's");
  add(sub, "FILE", o.file, "FILE",
      "Region: WKT, GeoJSON, [[x,y],...] or {\"polygon\": ...}; or a mesh: NAME.msh")
      ->required();
  CLI::Option* cells =
      sub->add_option("--voronoi", o.voronoi.cells, "Number of Voronoi cells")->transform(kWhole);
  sub->add_option("--seed", o.voronoi.seed, "Of the random sites")
      ->transform(kWhole)
      ->needs(cells)
      ->capture_default_str();
  sub->add_option("--lloyd", o.voronoi.lloyd, "Steps of Lloyd's iteration, at most")
      ->transform(kWhole)
      ->needs(cells)
      ->capture_default_str();
  sub->add_option("--shortest-edge", o.voronoi.shortest_edge,
                  "Collapse shorter edges; 0 to 0.5, of the mean cell size sqrt(area / cells)")
      ->check(kDecimal)
      ->needs(cells)
      ->capture_default_str();
  sub->add_flag("--convex", o.voronoi.convex, "Cut cells that are not convex")->needs(cells);
  sub->add_option("--smallest-angle", o.voronoi.smallest_angle,
                  "Move nodes until no angle is below it where possible; 0 to pi/3, in rad")
      ->check(kDecimal)
      ->needs(cells)
      ->capture_default_str();
  sub->add_flag("--json", o.json, "Print the description of a mesh as JSON")->excludes(cells);
  add(sub, "-o,--output", o.output, "FILE",
      "File for the cells: .json for points and cells, .wkt, .geojson, .svg or .vtu for polygons "
      "(default: JSON on standard output for Voronoi cells, none for a mesh)");
  add(sub, "--vtk", o.vtk, "FILE", "VTK file (.vtu) to look at");
  sub->final_callback([&o, cells] { o.make = cells->count() > 0; });
}

void add_polygon(CLI::App& app, PolygonOptions& o) {
  CLI::App* sub = app.add_subcommand("polygon", "A polygon's roof, singular area and circles");
  CLI::Option* file =
      add(sub, "FILE", o.file, "FILE", "Polygon: WKT, GeoJSON, [[x,y],...] or {\"polygon\": ...}");
  CLI::Option* batch =
      add(sub, "--batch", o.batch, "FILE",
          "File with one polygon per line: name n x y ..., or name POLYGON ((x y, ...))")
          ->excludes(file);
  add(sub, "--reference", o.reference, "REFERENCE", "roof, inscribed_circle or a length in m")
      ->capture_default_str();
  sub->add_option("--vtk", o.vtk, "Folder for faces.vtu and singular_area.vtu")
      ->type_name("DIR")
      ->excludes(batch);
  CLI::Option* picture =
      sub->add_option("--picture", o.picture, "Picture of the potential, .png or .svg")
          ->type_name("FILE")
          ->excludes(batch);
  CLI::Option* shapes =
      sub->add_option(
             "--output", o.shapes,
             "What to write to the file of -o: skeleton, faces, offset:D (the polygon with "
             "its sides moved inwards by D in m), singular-area or incircle")
          ->type_name("WHAT")
          ->excludes(batch);
  sub->add_option("-o", o.output,
                  std::string("File for what --output or --repair give: ") + kShapeFormats)
      ->type_name("FILE")
      ->excludes(batch);
  CLI::Option* at =
      sub->add_option("--at", o.at,
                      "Potential, gradient and distance from the boundary at a point, m, instead")
          ->type_name("X,Y")
          ->delimiter(',')
          ->check(kDecimal)
          ->expected(2)
          ->excludes(batch);
  CLI::Option* points =
      sub->add_option("--points", o.points, "The same at the points of a CSV file: x,y in each row")
          ->type_name("FILE")
          ->excludes(batch)
          ->excludes(at);
  CLI::Option* repair =
      sub->add_flag("--repair", o.repair,
                    "List the faults of all outlines of the file (also .dxf and .csv) and repair "
                    "them, instead")
          ->excludes(batch);
  sub->add_option(
         "--tolerance", o.tolerance,
         "Gaps that are closed, and distance by which outlines are simplified, m (default: "
         "a millionth of the extent for gaps, no simplification)")
      ->check(kPositive)
      ->needs(repair);
  for (CLI::Option* other : {picture, shapes}) {
    for (CLI::Option* instead : {at, points, repair}) other->excludes(instead);
  }
  repair->excludes(at)->excludes(points);
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_accuracy(CLI::App& app, AccuracyOptions& o) {
  CLI::App* sub = app.add_subcommand("accuracy", "Speed against error of the contact methods");
  CLI::Option* cases = add(sub, "--cases", o.cases, "FILE",
                           "Files of pairs (JSON, or lines as of contact --batch) instead of ours");
  add(sub, "-o,--output", o.folder, "DIR", "Output folder")->capture_default_str();
  add_whole(sub, "--repeat", o.repetitions, 1000, "Measure times so often, and print their range")
      ->capture_default_str();
  add(sub, "--write-cases", o.write_cases, "FILE",
      "Write our hard pairs with expected values to this file, and end")
      ->excludes(cases);
}

void add_benchmark(CLI::App& app, BenchmarkOptions& o) {
  CLI::App* sub = app.add_subcommand("benchmark", "Times of kernels and scenes on this machine");
  CLI::Option* list = sub->add_flag("--list", o.list, "List the cases and time none");
  add(sub, "--filter", o.filter, "REGEX",
      "Only cases whose names this regular expression finds, long ones too");
  add_whole(sub, "--repeat", o.repetitions, 1000, "Time each case so often; the median counts")
      ->capture_default_str();
  add_threads(sub, o.threads, "Threads of scenes and elements");
  sub->add_flag("--quick", o.quick, "Take a tenth of the time for each repetition");
  add(sub, "--compare", o.compare, "FILE",
      "Run this build of the program alternately, and print ratios of times")
      ->excludes(list);
  add(sub, "-o,--output", o.folder, "DIR", "Folder for CSV and picture (default: none)")
      ->excludes(list);
  sub->add_flag("--json", o.json, "Print JSON");
}

void add_reproduce(CLI::App& app, ReproduceOptions& o) {
  CLI::App* sub = app.add_subcommand("reproduce", "The paper's figures: runs, curves and a report");
  sub->add_option("LIST", o.figures, "Names of figures, or all; nothing lists them")
      ->delimiter(',');
  add(sub, "-o,--output", o.folder, "DIR", "Output folder")->capture_default_str();
  add(sub, "--data", o.data, "DIR", "Folder with figures, scenes and reference (default: ours)");
  add_threads(sub, o.threads);
  sub->add_flag("--quick", o.quick, "Make studies with a few runs, in minutes");
  sub->add_flag("--verify", o.verify, "Exit with 1 if a number misses its tolerance");
}

void add_view(CLI::App& app, ViewOptions& o) {
  CLI::App* sub =
      app.add_subcommand("view", "Play a run in a browser, from one HTML file; or as a movie");
  add(sub, "DIR", o.folder, "DIR", "Folder of the results")->required();
  CLI::Option* page =
      add(sub, "-o,--output", o.output, "FILE", "HTML file (default: view.html in DIR)");
  CLI::Option* movie =
      add(sub, "--movie", o.movie, "FILE", "Write a movie instead, .mp4 or .gif; needs ffmpeg")
          ->excludes(page);
  sub->add_option("--colour", o.colour, "Quantity that colours the movie, as in picture")
      ->check(CLI::IsMember(names_of(field_quantities())))
      ->needs(movie);
  sub->add_flag("--chains", o.chains, "Contact forces as lines in the movie")->needs(movie);
  add_window(sub, o.window)->needs(movie);
  add_range(sub, o.range)->needs(movie);
  add_whole(sub, "--rate", o.rate, 60, "Frames of the run per second of the movie")
      ->capture_default_str()
      ->needs(movie);
}

void add_completion(CLI::App& app, CompletionOptions& o) {
  app.add_subcommand("completion", "Print a script that completes the command line in a shell")
      ->add_option("SHELL", o.shell, "The shell")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->required();
}

}  // namespace

void add_commands(CLI::App& app, Options& options) {
  app.footer(
      "Exit codes: 0 done; 1 an expectation or a tolerance was missed, or runs of a sweep failed; "
      "2 bad input or usage; 3 "
      "the simulation became unstable or left the range of the method; 4 the system failed; 130 "
      "interrupted.");
  app.set_version_flag("--version", std::string("apothem ") + kVersion);
  app.require_subcommand(1);
  add_run(app, options.run);
  add_sweep(app, options.sweep);
  add_picture(app, options.picture);
  add_check(app, options.check);
  add_modes(app, options.modes);
  add_contact(app, options.contact);
  add_polygon(app, options.polygon);
  add_boolean(app, options.boolean);
  add_mesh(app, options.mesh);
  add_accuracy(app, options.accuracy);
  add_benchmark(app, options.benchmark);
  add_reproduce(app, options.reproduce);
  add_view(app, options.view);
  add_completion(app, options.completion);
  app.add_subcommand("manual", "Print the manual page, for man -l -");
}

}  // namespace apothem
