// The program: the sub-command that the command line asks for, and the exit code and message of
// each kind of failure.

#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>

#include "apps/command_line/completion.hpp"
#include "apps/command_line/manual.hpp"
#include "apps/command_line/options.hpp"
#include "apps/command_line/usage.hpp"
#include "apps/process/out_of_memory.hpp"
#include "apps/process/signals.hpp"
#include "apps/process/work_line.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/system/standard_files.hpp"
#include "lib/text/error.hpp"

namespace {

using namespace apothem;
using Json = nlohmann::ordered_json;

// The place of an error, as far as it is known.
Json place(const SceneError& error) {
  Json json;
  json["file"] = error.file();
  if (error.line() > 0) json["line"] = error.line();
  if (!error.pointer().empty()) json["pointer"] = error.pointer();
  if (const auto* polygon = dynamic_cast<const PolygonError*>(&error)) {
    if (polygon->vertex() >= 0) json["vertex"] = polygon->vertex();
    if (polygon->hole()) json["hole"] = *polygon->hole();
  }
  return json;
}

int run(int argc, char** argv) {
  CLI::App app{"Apothem: distance-potential finite-discrete element method in 2-D", "apothem"};
  Options options;
  add_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // after --help or --version
    throw UsageError(usage_message(app, error));
  }
  if (app.got_subcommand("completion")) {
    const bool bash = options.completion.shell == "bash";
    fmt::print("{}", bash ? bash_completion(app) : zsh_completion(app));
    return exit_code::done;
  }
  if (app.got_subcommand("manual")) {
    fmt::print("{}", manual_page(app));
    return exit_code::done;
  }
  if (app.got_subcommand("run")) return run_command(options.run);
  if (app.got_subcommand("sweep")) return sweep_command(options.sweep);
  if (app.got_subcommand("picture")) return picture_command(options.picture);
  if (app.got_subcommand("check")) return check_command(options.check);
  if (app.got_subcommand("modes")) return modes_command(options.modes);
  if (app.got_subcommand("mesh")) return mesh_command(options.mesh);
  if (app.got_subcommand("polygon")) return polygon_command(options.polygon);
  if (app.got_subcommand("boolean")) return boolean_command(options.boolean);
  if (app.got_subcommand("accuracy")) return accuracy_command(options.accuracy);
  if (app.got_subcommand("benchmark")) return benchmark_command(options.benchmark);
  if (app.got_subcommand("reproduce")) return reproduce_command(options.reproduce);
  if (app.got_subcommand("view")) return view_command(options.view);
  return contact_command(options.contact);
}

// Says on standard error what has failed and, where JSON is asked for, as an object on standard
// output too.
class Failure {
 public:
  Failure(int argc, char** argv)
      : json_(std::any_of(argv, argv + argc,
                          [](const char* word) { return std::string(word) == "--json"; })) {
    if (json_) say_endings_in_json();
  }

  int operator()(int code, const std::string& message) const {
    return operator()(code, message, {{"error", message}});
  }
  int operator()(const SceneError& error) const {
    Json object{{"error", error.reason()}};
    object.update(place(error));
    return operator()(exit_code::bad_input, error.what(), object);
  }

 private:
  int operator()(int code, const std::string& message, const Json& object) const {
    fmt::print(stderr, "apothem: {}\n", message);
    if (json_) {
      fmt::print("{}\n", object.dump(-1, ' ', false, Json::error_handler_t::replace));
      std::fflush(stdout);
    }
    return code;
  }

  bool json_;
};

// Every array of a frame is compressed in memory of its own. Given back to the system and asked for
// again each time, this takes a third of the time of writing.
void keep_memory() {
#ifdef __GLIBC__
  constexpr int kKept = 1 << 24, kLargest = 1 << 25;  // bytes
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kLargest);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  heed_signals();
  open_standard_files();
  keep_memory();
  heed_lack_of_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a limit on file sizes becomes an error of write()
  const Failure fail(argc, argv);
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return fail(exit_code::system_failed, "standard output cannot be written");
    }
    return code;
  } catch (const SceneError& error) {
    return fail(error);
  } catch (const UsageError& error) {
    return fail(exit_code::bad_input, error.what());
  } catch (const ResultsError& error) {
    return fail(exit_code::bad_input, error.what());
  } catch (const Unstable& error) {
    return fail(exit_code::unstable, error.what());
  } catch (const Stopped& stopped) {
    return fail(exit_code::interrupted, stopped.what());
  } catch (const Interrupted& interrupt) {
    return fail(exit_code::interrupted, interrupt.what());
  } catch (const std::bad_alloc&) {
    return fail(exit_code::system_failed, "out of memory");
  } catch (const std::exception& error) {
    // Failures of the system, like a full disk, a full pipe or a file name that it refuses.
    return fail(exit_code::system_failed, error.what());
  }
}
