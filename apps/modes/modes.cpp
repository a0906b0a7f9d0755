// apothem modes: frequencies and shapes of small vibrations, and buckling loads.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "lib/dynamics/contact_term.hpp"
#include "lib/output/files.hpp"
#include "lib/run/folder.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/mode_frames.hpp"
#include "lib/run/run.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBalanced = 1e-5;   // forces out of balance over loads
constexpr double kSymmetric = 1e-9;  // part of the stiffness that is not symmetric
constexpr const char* kTable = "modes.csv";
constexpr const char* kSummary = "modes.json";

// Where the modes belong to, and what has been found.
struct Analysis {
  Linearised scene;
  SceneModes modes;
  double time = 0;      // s
  double unloaded = 0;  // of buckling: time of the other end, s
  std::vector<std::string> notes;
};

Linearised linearise(Run& run) {
  std::optional<Linearised> scene = linearised(run.simulation());
  if (scene) return std::move(*scene);
  throw SceneError(
      run.scene().file,
      "the stiffness of its contacts is not known, so it has no modes: leave out \"surface\": "
      "\"element\" and the friction law \"per_edge\" in contact");
}

// The names of bodies that something else than a force moves along.
std::string servo_walls(const Model& model) {
  std::string names;
  for (const RigidBody& body : model.bodies) {
    if (body.servo) names += (names.empty() ? "\"" : ", \"") + body.name + '"';
  }
  return names;
}

bool is_damped(const Model& model) {
  bool damped = model.contact.damping.normal > 0 || model.contact.damping.tangential > 0 ||
                model.contact.damping.bulk > 0;
  for (const Material& m : model.materials) {
    damped = damped || m.mass_damping > 0 || m.stiffness_damping > 0;
  }
  return damped;
}

std::string counted(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void add_note(Analysis& found, std::string sentence) { found.notes.push_back(std::move(sentence)); }

void note_ways_to_fall(Analysis& found) {
  const SceneModes& modes = found.modes;
  if (modes.unstable > 0) {
    add_note(found, fmt::format("unstable: {} without bound from the smallest push",
                                counted(modes.unstable, "mode grows", "modes grow")));
  }
  if (modes.rigid > 0) {
    add_note(found,
             fmt::format("{} at 0 Hz, which nothing resists{}",
                         counted(modes.rigid, "rigid-body mode", "rigid-body modes"),
                         modes.rigid > kMostRigidShapes ? "; their shapes are left out" : ""));
  }
}

void note_contacts(const Model& model, Analysis& found) {
  const Linearised& scene = found.scene;
  if (!scene.touching.empty()) {
    const TouchingBodies& first = scene.touching.front();
    const std::string closed =
        scene.overlapping > 0
            ? fmt::format(", but {} as closed, because rounding makes the outlines overlap",
                          counted(scene.overlapping, "patch counts", "patches count"))
            : "";
    add_note(found, fmt::format("{} without pressing on each other, first \"{}\" and \"{}\": such "
                                "contacts count as open{}",
                                counted(static_cast<int>(scene.touching.size()),
                                        "pair of bodies touches", "pairs of bodies touch"),
                                model.name_of(first.a), model.name_of(first.b), closed));
  }
  if (scene.friction) add_note(found, "friction counts as sticking in all contacts that press");
}

void add_notes(const Run& run, Analysis& found) {
  const Model& model = run.scene().model;
  note_ways_to_fall(found);
  note_contacts(model, found);
  if (found.scene.unbalanced > kBalanced) {
    add_note(found,
             fmt::format("the bodies are not in equilibrium: forces out of balance are {:.2g} "
                         "of the loads; these are the modes of the places as given (\"start\": "
                         "\"settled\" or \"mode\": \"static\" in time finds the equilibrium)",
                         found.scene.unbalanced));
  }
  if (found.modes.skew > kSymmetric) {
    add_note(found, fmt::format("the stiffness is not symmetric, by {:.2g} of its norm, as loaded "
                                "friction or pressures make it: its symmetric part counts",
                                found.modes.skew));
  }
  if (is_damped(model)) add_note(found, "damping is left out");
  const std::string walls = servo_walls(model);
  if (!walls.empty()) add_note(found, "walls that hold a force stay where they are: " + walls);
}

// The scene where it begins, or in its last equilibrium.
Analysis vibrations(Run& run, int count) {
  if (run.scene().time.statics) run.advance();
  Analysis found;
  found.scene = linearise(run);
  found.time = run.state().time;
  found.modes = modes_of(found.scene, count);
  return found;
}

// With contacts, which close under load, the stiffness changes from the first load step to the last
// one; without, from the unloaded scene.
Analysis bucklings(Run& run, int count) {
  const Scene& scene = run.scene();
  const double step = scene.time.end / scene.time.load_steps;
  const bool touches = ContactTerm::needed(scene.model);
  if (touches && scene.time.load_steps < 2) {
    throw SceneError(scene.file,
                     "buckling of a scene with contacts needs two load steps or more: raise "
                     "load_steps in time");
  }
  if (touches) run.advance(step);
  Analysis found;
  found.unloaded = run.state().time;
  const Linearised unloaded = linearise(run);
  run.advance();
  found.scene = linearise(run);
  found.time = run.state().time;
  found.modes = buckling_of(unloaded, found.scene, count);
  // The factor of what has changed, as one of the loads.
  const double share = found.unloaded / found.time;
  for (SceneMode& mode : found.modes.modes) {
    mode.eigenvalue = share + (1 - share) * mode.eigenvalue;
  }
  return found;
}

std::string mode_folder(size_t number) { return fmt::format("mode-{:02}", number); }

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json mode_json(const SceneMode& mode, size_t number, bool with_folder) {
  Json json{{"number", number}, {"kind", kModeKinds[static_cast<size_t>(mode.kind)]}};
  if (mode.kind == ModeKind::buckling) {
    json["load_factor"] = mode.eigenvalue;
  } else {
    json["frequency"] = mode.frequency();
    json["period"] = number_or_null(mode.period());
    json["growth_rate"] = mode.growth_rate();
    json["mass_share"] = {mode.share[0], mode.share[1]};
  }
  if (with_folder) json["folder"] = mode_folder(number);
  return json;
}

std::string json_text(const Run& run, const Analysis& found, const ModesOptions& options) {
  Json json{{"scene", run.scene().file},
            {"name", run.scene().model.name},
            {"analysis", options.buckling ? "buckling" : "vibration"},
            {"state", run.scene().time.statics ? "equilibrium" : "start"},
            {"time", found.time},
            {"coordinates", found.modes.coordinates},
            {"contacts", found.scene.contacts},
            {"mass", {found.modes.mass[0], found.modes.mass[1]}}};
  if (!options.buckling) {
    json["unstable"] = found.modes.unstable;
    json["rigid"] = found.modes.rigid;
    json["unbalanced"] = found.scene.unbalanced;
    json["asymmetry"] = found.modes.skew;
  }
  json["modes"] = Json::array();
  for (size_t i = 0; i < found.modes.modes.size(); ++i) {
    json["modes"].push_back(mode_json(found.modes.modes[i], i + 1, !options.folder.empty()));
  }
  json["notes"] = found.notes;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string csv_text(const Analysis& found) {
  std::string text =
      "mode,kind,frequency [Hz],period [s],growth_rate [1/s],load_factor,mass_share_x,"
      "mass_share_y\n";
  for (size_t i = 0; i < found.modes.modes.size(); ++i) {
    const SceneMode& mode = found.modes.modes[i];
    const bool buckling = mode.kind == ModeKind::buckling;
    text += fmt::format("{},{},{},{},{},{},{},{}\n", i + 1,
                        kModeKinds[static_cast<size_t>(mode.kind)], mode.frequency(), mode.period(),
                        mode.growth_rate(), buckling ? fmt::format("{}", mode.eigenvalue) : "",
                        mode.share[0], mode.share[1]);
  }
  return text;
}

bool is_rigid(const SceneMode& mode) { return mode.kind == ModeKind::rigid; }

// The row of modes from `first` to `last`, counted from 1, which have the same frequency.
void print_row(size_t first, size_t last, const SceneMode& mode,
               const std::array<double, 2>& share) {
  const std::string number =
      first == last ? fmt::format("{}", last) : fmt::format("{}-{}", first, last);
  const std::string period =
      std::isfinite(mode.period()) ? fmt::format("{:.6g}", mode.period()) : "-";
  std::string kind = kModeKinds[static_cast<size_t>(mode.kind)];
  if (mode.kind == ModeKind::unstable) {
    kind += fmt::format(", grows like exp({:.6g} t/s)", mode.growth_rate());
  }
  fmt::print("{:>5}  {:>14.6g}  {:>12}  {:>6.2f}%  {:>6.2f}%  {}\n", number, mode.frequency(),
             period, 100 * share[0], 100 * share[1], kind);
}

void print_vibrations(const Run& run, const Analysis& found) {
  const SceneModes& modes = found.modes;
  fmt::print("{}: modes {} at t = {:.6g} s; {}, {}\n", run.scene().model.name,
             run.scene().time.statics ? "about the equilibrium" : "of the bodies as they begin",
             found.time, counted(modes.coordinates, "free coordinate", "free coordinates"),
             counted(found.scene.contacts, "contact", "contacts"));
  fmt::print("{:>5}  {:>14}  {:>12}  {:>7}  {:>7}  {}\n", "mode", "frequency [Hz]", "period [s]",
             "mass x", "mass y", "kind");
  std::array<double, 2> sum{};
  for (size_t i = 0; i < modes.modes.size(); ++i) {
    // All modes at 0 Hz are one row.
    size_t last = i;
    std::array<double, 2> share{};
    while (last < modes.modes.size() && (last == i || is_rigid(modes.modes[i])) &&
           is_rigid(modes.modes[last]) == is_rigid(modes.modes[i])) {
      for (const size_t axis : {0, 1}) share[axis] += modes.modes[last].share[axis];
      ++last;
    }
    print_row(i + 1, last, modes.modes[i], share);
    for (const size_t axis : {0, 1}) sum[axis] += share[axis];
    i = last - 1;
  }
  fmt::print("{:>5}  {:>14}  {:>12}  {:>6.2f}%  {:>6.2f}%  of {:.6g} and {:.6g} kg\n", "sum", "",
             "", 100 * sum[0], 100 * sum[1], modes.mass[0], modes.mass[1]);
}

void print_buckling(const Run& run, const Analysis& found) {
  const std::string from = found.unloaded > 0 ? fmt::format("that of t = {:.6g} s", found.unloaded)
                                              : std::string("that without loads");
  fmt::print("{}: linear buckling, from the stiffness at t = {:.6g} s and {}; {}\n",
             run.scene().model.name, found.time, from,
             counted(found.modes.coordinates, "free coordinate", "free coordinates"));
  if (found.modes.modes.empty()) {
    fmt::print("no multiple of these loads makes the scene unstable\n");
    return;
  }
  fmt::print("{:>4}  {:>15}\n", "mode", "load factor");
  for (size_t i = 0; i < found.modes.modes.size(); ++i) {
    fmt::print("{:>4}  {:>15.8g}\n", i + 1, found.modes.modes[i].eigenvalue);
  }
}

// Takes a folder for these results, as a run does.
void prepare(const std::string& folder, const Run& run, bool overwrite, FileList& list) {
  prepare_folder(folder,
                 {"modes of " + run.hash_of_scene(),
                  overwrite,
                  inputs_of(run.scene(), {}),
                  {kTable, kSummary}},
                 list);
}

// Folders of modes that an earlier call has found, and this one has not.
void remove_others(const std::string& folder, size_t from, const Run& run) {
  namespace fs = std::filesystem;
  for (size_t i = from;; ++i) {
    const std::string old = folder + "/" + mode_folder(i);
    std::error_code ignored;
    if (!fs::is_directory(old, ignored)) return;
    {
      FileList list(old);
      prepare(old, run, true, list);
      list.begin("", {});
    }
    for (const char* part : {"/frames", "/run.files", ""}) fs::remove(old + part, ignored);
  }
}

void write_results(const Run& run, const Analysis& found, const ModesOptions& options) {
  FileList files(options.folder);
  prepare(options.folder, run, options.overwrite, files);
  const size_t count = found.modes.modes.size();
  for (size_t i = 0; i < count; ++i) {
    const std::string folder = options.folder + "/" + mode_folder(i + 1);
    FileList list(folder);
    prepare(folder, run, options.overwrite, list);
    write_mode_frames(folder, run.simulation(), found.modes.modes[i], options.threads, &list);
  }
  remove_others(options.folder, count + 1, run);
  write_file(options.folder + "/" + kTable, csv_text(found));
  write_file(options.folder + "/" + kSummary, json_text(run, found, options));
}

}  // namespace

int modes_command(const ModesOptions& options) {
  Scene scene = read_scene(options.scene, settings_of(options.set, options.scene));
  if (options.buckling && !scene.time.statics) {
    throw scene.error_at("/time",
                         "buckling is that of an equilibrium under loads: say \"mode\": "
                         "\"static\" in \"time\"");
  }
  Run run(std::move(scene), {.threads = options.threads});
  for (const std::string& warning : run.warnings()) {
    fmt::print(stderr, "apothem: warning: {}\n", warning);
  }
  Analysis found;
  try {
    found = options.buckling ? bucklings(run, options.count) : vibrations(run, options.count);
  } catch (const NoModes& error) {
    throw SceneError(run.scene().file, error.what());
  }
  if (!options.buckling) add_notes(run, found);
  if (!options.folder.empty()) write_results(run, found, options);
  if (options.json) {
    fmt::print("{}", json_text(run, found, options));
    return exit_code::done;
  }
  if (options.buckling) {
    print_buckling(run, found);
  } else {
    print_vibrations(run, found);
  }
  for (const std::string& note : found.notes) fmt::print("note: {}\n", note);
  if (!options.folder.empty())
    fmt::print("frames of the modes, and {}: {}\n", kTable, options.folder);
  return exit_code::done;
}

}  // namespace apothem
