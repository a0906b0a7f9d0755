#include "lib/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>

#include "lib/dynamics/unstable.hpp"
#include "lib/output/files.hpp"
#include "lib/run/folder.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/other_run.hpp"
#include "lib/run/summary.hpp"
#include "lib/run/warnings.hpp"
#include "lib/scene/plausibility.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

constexpr std::int64_t kLookEvery = 64;  // steps between looks at the clock

}  // namespace

bool Schedule::due(double time, double step) {
  if (!(time >= static_cast<double>(next_) * interval_ - 1e-6 * step)) return false;
  next_ = static_cast<std::int64_t>(std::floor(time / interval_ + 1e-6)) + 1;
  return true;
}

Run::Run(Scene scene, const RunSettings& settings)
    : scene_(std::move(scene)), settings_(settings), scene_hash_(scene_hash(scene_)) {
  for (const std::string& made : scene_.warnings) warn(made);
  for (std::string& unlikely : unlikely_values(scene_)) warn(std::move(unlikely));
  scene_.drop_rings();
  const HistoryWriter::Parts histories = start();
  scene_.document = JsonValue();  // only errors at the start need their places
  const std::string& folder = settings_.folder;
  if (!settings_.resume) progress_.load_path = LoadPath(scene_.time.end);
  rows_ = Schedule(scene_.output.history_interval, progress_.next_row);
  pictures_ = Schedule(scene_.time.end / std::max(scene_.output.frames, 1), progress_.next_frame);
  if (scene_.automatic_scheme && scene_.time.scheme == TimeScheme::verlet) {
    quiet_.emplace(scene_.model, simulation_->degrees_of_freedom(), scene_.time.accuracy);
  }
  start_ = last_checkpoint_ = Clock::now();
  processor_start_ = processor_time();
  if (folder.empty()) return;
  history_.emplace(folder, scene_.model, scene_.output, histories);
  frames_.emplace(folder, scene_.model, progress_.frame_times, settings_.threads, files_.get(),
                  scene_.frame_format);
}

// Takes the folder for a run that begins there.
void Run::prepare() {
  const std::string& folder = settings_.folder;
  if (folder.empty()) return;
  std::vector<std::string> others;
  if (!settings_.saved.empty()) others.push_back(settings_.saved);
  if (!settings_.from.empty()) {
    for (const StateFile kind : {StateFile::final, StateFile::checkpoint}) {
      others.push_back(state_file(settings_.from, kind));
    }
  }
  files_ = std::make_unique<FileList>(folder);
  prepare_folder(
      folder, {scene_hash_, settings_.overwrite, inputs_of(scene_, others), settings_.other_files},
      *files_);
}

// The simulation where the run in the folder has left it, and the histories up to there.
HistoryWriter::Parts Run::resume() {
  const std::string& folder = settings_.folder;
  const std::string checkpoint = state_file(folder, StateFile::checkpoint);
  if (!has_checkpoint(folder)) read_progress(checkpoint);  // says what helps
  files_ = std::make_unique<FileList>(folder);
  lock_folder(*files_, folder);
  HistoryWriter::Parts histories;
  const std::string fault = use_checkpoint(folder, [&](const std::string& file) {
    histories = required_histories(folder, read_progress(file));
    go_on(file);
    refuse_other_columns(folder, history_header(scene_.model, scene_.output));
    refuse_other_beginning();
  });
  last_row_ = progress_.last_row, last_frame_ = progress_.last_frame;
  reopen_folder(folder, {scene_hash_, false, {}, settings_.other_files}, *files_);
  if (!fault.empty()) {
    std::error_code error;
    std::filesystem::rename(state_file(folder, StateFile::previous), checkpoint, error);
    if (error) throw SystemFailure(checkpoint, error.value());
    warn(fmt::format(
        "the run goes on from the checkpoint before the last one, at t = {:.9g} s, and does again "
        "what came after: {}",
        state().time, fault));
  }
  return histories;
}

void Run::refuse_other_beginning() const {
  if (settings_.from.empty() || settings_.from == progress_.beginning.folder) return;
  throw SceneError(settings_.folder,
                   fmt::format("holds a run that has not begun with that in \"{}\"; leave out "
                               "--from, or choose another folder",
                               settings_.from));
}

// The simulation where it begins, or where it goes on, and the histories up to there.
HistoryWriter::Parts Run::start() {
  progress_.stop_watch = &stop_watch_;
  if (settings_.resume) return resume();
  if (!settings_.saved.empty()) {
    go_on(settings_.saved);
    progress_.histories.clear();
    progress_.frame_times.clear();
    prepare();
    return {};
  }
  std::optional<OtherRun> other;
  if (!settings_.from.empty()) {
    other.emplace(settings_.from, settings_.from_time);
    progress_.beginning = other->move_into(scene_);
  }
  if (other && scene_.rigid) {
    throw scene_.error_at("/contact/rigid",
                          "is not supported yet for a run that begins with another one, whose "
                          "contacts have their own stiffness; leave out --from");
  }
  stiffen();
  simulation_ = make_simulation(scene_, settings_.threads, other ? Start::other_run : Start::scene,
                                settings_.stop_if);
  if (other) {
    other->hand_contacts_to(*simulation_);
    if (scene_.time.settled) settle(scene_, *simulation_, settings_.stop_if);
  }
  if (scene_.time.settled) {
    if (std::string sentence = describe_settling(scene_, *simulation_); !sentence.empty()) {
      warn(std::move(sentence));
    }
  }
  const std::vector<PairDepth> overlaps = simulation_->overlaps();
  if (!other && !overlaps.empty() && overlaps.front().share > kSmallOverlap) {
    warn("bodies overlap at the start: " + describe_overlaps(*simulation_));
  }
  const Population* const population = simulation_->population();
  const int outside = population ? population->count_outside(state()) : 0;
  if (outside > 0) {
    warn(fmt::format("{} {} outside of the world: check \"box\" in \"world\"", outside,
                     outside == 1 ? "body begins" : "bodies begin"));
  }
  if (std::string sentence = rules_in_vain(scene_.model, scene_.stops, state());
      !sentence.empty() && outside == 0) {
    warn(std::move(sentence));
  }
  prepare();
  return {};
}

// Results are those of the stiffest pass.
void Run::stiffen() {
  if (!scene_.rigid) return;
  if (progress_.rigid.passes.empty()) {
    try {
      progress_.rigid =
          find_rigid_limit(scene_.model, scene_.time, settings_.threads, settings_.stop_if);
    } catch (const Unrunnable& error) {
      throw scene_.error_at("/" + error.key(), error.what());
    }
  }
  const double own = scene_.model.contact.normal_stiffness;
  scene_.model = stiffened(std::move(scene_.model), progress_.rigid.passes.back().stiffness / own);
}

void Run::go_on(const std::string& file) {
  const RunProgress progress = read_progress(file);
  begin_at(scene_.model, progress.beginning.bodies);
  progress_.rigid = progress.rigid;
  stiffen();
  simulation_ = make_simulation(scene_, settings_.threads, Start::checkpoint);
  read_state(file, scene_hash_, *simulation_, progress_);
  forces_before_ = progress_.forces;
}

double Run::seconds() const { return seconds_since(start_); }

double Run::processor_seconds() const { return processor_time() - processor_start_; }

bool Run::reached(double time) const {
  if (scene_.time.statics) return state().time >= time * (1 - 1e-12);
  return state().time >= time - 1e-6 * simulation_->step_size();
}

void Run::add_force(const std::string& name, AppliedForce::Function function) {
  if (simulation_->own_steps() > 0) {
    throw std::logic_error("a force must be added before the first step");
  }
  forces_.push_back({name});
  simulation_->add(
      std::make_unique<AppliedForce>(name, simulation_->degrees_of_freedom(), std::move(function)));
}

// Remembers why the run cannot go on.
template <class Work>
void Run::note_failures(const Work& work) {
  try {
    try {
      work();
    } catch (const Unstable& error) {
      status_ = Status::unstable;
      message_ = with_key_of_step(error.what(), scene_.time);
      flush();
      throw Unstable(message_, error.body());
    }
  } catch (const SystemFailure& error) {
    status_ = Status::failed;
    message_ = error.what();
    try {
      if (!settings_.folder.empty()) write_summary(*this);
    } catch (const SystemFailure&) {
      // The one that is thrown below came first.
    }
    throw;
  }
}

bool Run::step() {
  bool taken = false;
  note_failures([&] { taken = try_step(); });
  return taken;
}

// A run that goes on without a force that it had would not be the same run.
void Run::require_forces() const {
  if (!forces_before_ || forces_ == *forces_before_) return;
  std::string list;
  for (const AddedForce& force : *forces_before_) {
    list += (list.empty() ? "\"" : ", \"") + force.name + '"';
  }
  throw SceneError(
      scene_.file,
      forces_before_->empty()
          ? "the run that goes on here had no added forces; leave them out"
          : fmt::format("the run that goes on here had the added forces {}; add them again, in "
                        "this order",
                        list));
}

// Whether it is time to look at the clock and at the rules. An implicit step counts many.
bool Run::is_look() const {
  return scene_.time.statics || state().step / kLookEvery != step_before_ / kLookEvery;
}

bool Run::try_step() {
  if (reached(scene_.time.end) || !stopped_by_.empty()) return false;
  require_forces();
  forces_before_.reset();
  if (last_row_ < 0 && !settings_.resume) record(true, true);
  step_before_ = state().step;
  if (scene_.time.statics) {
    if (!load_step()) return false;
  } else {
    dynamic_step();
  }
  if (is_look()) {
    look_for_stop();
    look_for_rest();
  }
  if (on_step_) on_step_();
  if (ended()) simulation_->check_energy();
  return true;
}

// The next time at which something is recorded, or the run ends, s. It does not depend on what the
// caller is going to do, so that a run that is stopped goes on bit for bit.
double Run::horizon() const { return std::min({scene_.time.end, rows_.time(), pictures_.time()}); }

void Run::dynamic_step() {
  simulation_->step(horizon());
  const double step = simulation_->step_size();
  const bool last = reached(scene_.time.end);
  const bool row = rows_.due(state().time, step);
  const bool frame = pictures_.due(state().time, step) && scene_.output.frames > 0;
  record(row || last, frame || last);
}

void Run::loop(double until) {
  if (!settings_.resume && state().step == 0) record(true, true);
  const auto more = [&] {
    if (!scene_.time.statics) return !reached(until);
    // A load step is taken whole: only if it does not lead beyond the time.
    return !reached(scene_.time.end) && next_load_time() <= until * (1 + 1e-12);
  };
  while (!asked_to_stop() && stopped_by_.empty() && more() && step()) {
    if (!is_look()) continue;
    if (on_progress_) on_progress_(*this);
    // Not of a run that has just been stopped: a rule is looked at after a step, and a run that
    // goes on from here would take one more before it knows.
    if (stopped_by_.empty() && checkpoint_due()) write_checkpoint();
  }
  status_ = more() && !ended() ? Status::interrupted : Status::done;
}

bool Run::checkpoint_due() const {
  const std::optional<double>& interval = scene_.output.checkpoint_interval;
  return interval && history_ && seconds_since(last_checkpoint_) > *interval;
}

void Run::write_checkpoint() {
  write(StateFile::checkpoint);
  last_checkpoint_ = Clock::now();
}

bool Run::ended() const {
  return reached(scene_.time.end) ||
         (!stopped_by_.empty() && !stop_watch_.is_wall_clock(stopped_by_));
}

void Run::look_for_stop() {
  if (const Population* population = simulation_->population()) {
    if (population->outside() >= 0) stopped_by_ = kStoppedOutside;
  }
  if (scene_.stops.empty() || !stopped_by_.empty()) return;
  stopped_by_ = stop_watch_.look(state(), simulation_->node_mass(), seconds());
}

void Run::look_for_rest() {
  if (!quiet_) return;
  ++progress_.looks;
  progress_.quiet_looks += quiet_->holds(state(), simulation_->step_size());
}

std::optional<double> Run::quiet_share() const {
  if (!quiet_ || progress_.looks == 0) return {};
  return static_cast<double>(progress_.quiet_looks) / static_cast<double>(progress_.looks);
}

void Run::advance(std::optional<double> until) {
  if (files_) lock_folder(*files_, settings_.folder);
  note_failures([&] {
    loop(std::min(until.value_or(scene_.time.end), scene_.time.end));
    flush();
  });
}

Run::Status Run::finish() {
  // A run that has become unstable has said enough.
  if (status_ != Status::unstable) {
    note_failures([&] { close(); });
    for (std::string& sentence : warnings_of(scene_.model, simulation_->extremes(), load_steps())) {
      warn(with_key_of_step(std::move(sentence), scene_.time));
    }
    if (std::string sentence = rules_in_vain(scene_.model, scene_.stops, state());
        !sentence.empty() && stopped_by_.empty() &&
        std::ranges::find(warnings_, sentence) == warnings_.end()) {
      warn(std::move(sentence));
    }
  }
  if (!settings_.folder.empty()) {
    write_summary(*this);
    // Last of all: a run that is killed before goes on from there.
    if (status_ != Status::unstable && ended()) remove_checkpoint(settings_.folder);
    files_->unlock();
  }
  return status_;
}

void Run::fail(std::string message) {
  status_ = Status::failed;
  message_ = std::move(message);
  flush();
  if (!settings_.folder.empty()) write_summary(*this);
}

Run::Status Run::run(std::optional<double> until) {
  try {
    advance(until);
  } catch (const Unstable&) {
    // status() and message() say so.
  }
  return finish();
}

void Run::close() {
  // A run that was stepped by hand.
  if (status_ == Status::running) status_ = ended() ? Status::done : Status::interrupted;
  if (ended()) record(true, true);
  flush();
  if (ended()) {
    write(StateFile::final);
  } else {
    write(StateFile::checkpoint);
    if (!scene_.time.statics) {
      record(true, true);  // shows where the run stopped; a resumed run takes it back
      flush();
    }
  }
  if (status_ == Status::interrupted && !stopped_by_.empty()) {
    message_ =
        fmt::format("stopped by \"{}\" at t = {:.9g} s; all files are complete, --resume continues",
                    stopped_by_, state().time);
  } else if (status_ == Status::interrupted) {
    message_ = fmt::format(
        "interrupted at t = {:.9g} s; all files are complete, --resume continues", state().time);
  } else if (ended()) {
    judge();
  }
}

void Run::record(bool row, bool frame) {
  if (!history_ || !(row || frame)) return;
  const Clock::time_point before = Clock::now();
  if (row && last_row_ != state().step) write_row();
  if (frame && last_frame_ != state().step) write_frame();
  output_seconds_ += seconds_since(before);
}

void Run::write_row() {
  last_row_ = state().step;
  Simulation& s = *simulation_;
  const Model& model = scene_.model;
  const OutputSettings& output = scene_.output;
  std::vector<BodyStatistics> bodies;
  std::vector<RegionSums> regions;
  if (!(output.track.empty() && output.track_deformables.empty() && model.regions.empty())) {
    const std::vector<ContactRecord> contacts = s.contacts();
    bodies = body_statistics(model, s.state(), contacts, s.stresses());
    regions = region_sums(model, s.state(), s.node_mass(), contacts, bodies, scene_.time.statics);
  }
  history_->add(s.state(), s.energies_to_record(), s.momenta(),
                {s.contact_forces(), std::move(bodies), s.node_mass(), s.stresses(output.points),
                 output.track_surfaces.empty() ? std::vector<SurfaceRecord>{} : s.surfaces(),
                 std::move(regions)});
}

void Run::write_frame() {
  last_frame_ = state().step;
  history_->flush();
  const Simulation& s = *simulation_;
  const std::vector<ContactRecord> contacts = s.contacts();
  const std::vector<CauchyStress> stresses = s.stresses();
  frames_->write({s.state(), contacts, stresses, s.surfaces(), s.contact_forces(), s.node_mass(),
                  body_statistics(scene_.model, s.state(), contacts, stresses)});
}

void Run::flush() {
  if (history_) history_->flush();
}

void Run::update_progress() {
  if (history_) {
    history_->flush();
    const HistoryWriter::Parts parts = history_->parts();
    progress_.histories.clear();
    for (size_t i = 0; i < parts.size(); ++i) {
      progress_.histories.push_back({kHistoryFiles[i], parts[i].size, parts[i].checksum.text()});
    }
    progress_.frame_times = frames_->times();
  }
  progress_.next_row = rows_.next();
  progress_.next_frame = pictures_.next();
  progress_.last_row = last_row_, progress_.last_frame = last_frame_;
  progress_.forces = forces_before_.value_or(forces_);
}

void Run::write(StateFile kind) {
  if (!history_) return;
  // What a state goes with is on the disk before it.
  history_->make_last();
  frames_->make_last();
  files_->make_last();
  if (kind == StateFile::checkpoint) keep_checkpoint(settings_.folder);
  update_progress();
  write_state(state_file(settings_.folder, kind), scene_, scene_hash_, *simulation_, progress_);
}

void Run::save(const std::string& file) {
  update_progress();
  write_state(file, scene_, scene_hash_, *simulation_, progress_, true);
}

double Run::value_of(const Reduction& reduction) const {
  if (reduction.quantity != kCollapseFactor) return reduce(reduction, settings_.folder);
  return collapse_ ? collapse_->factor() : std::nan("");
}

void Run::judge() {
  if (settings_.folder.empty()) return;
  for (const Expectation& expectation : scene_.expectations) {
    try {
      const double value = value_of(expectation);
      outcomes_.push_back({value, std::abs(value - expectation.value) <= expectation.tolerance});
    } catch (const std::runtime_error&) {  // no row in its window
      outcomes_.push_back({std::nan(""), false});
    }
  }
  for (const Measure& measure : scene_.measures) {
    if (!measure.stopped_by.empty()) {
      measures_.push_back(measure.stopped_by == stopped_by_ ? 1 : 0);
      continue;
    }
    try {
      measures_.push_back(value_of(measure.of));
    } catch (const std::runtime_error&) {  // no row in its window
      measures_.push_back(std::nan(""));
    }
  }
}

}  // namespace apothem
