// Private header: the command line of all sub-commands. It is described once, to CLI11; help,
// hints, shell completion and the manual page all come from that description.
#pragma once

#include "apps/commands.hpp"

namespace CLI {
class App;
}

namespace apothem {

/// What the command line asks of each sub-command.
struct Options {
  RunOptions run;
  SweepOptions sweep;
  PictureOptions picture;
  CheckOptions check;
  ModesOptions modes;
  ContactOptions contact;
  PolygonOptions polygon;
  BooleanOptions boolean;
  MeshOptions mesh;
  AccuracyOptions accuracy;
  BenchmarkOptions benchmark;
  ReproduceOptions reproduce;
  ViewOptions view;
  CompletionOptions completion;
};

/// Adds all sub-commands and their options, which are written to `options`.
void add_commands(CLI::App& app, Options& options);

}  // namespace apothem
