#include "apps/sweep/run_pool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <sstream>
#include <string_view>

#include "apps/commands.hpp"
#include "apps/process/child_program.hpp"
#include "lib/output/files.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/system/clock.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

std::string messages_of(const std::string& folder) { return folder + "/messages.txt"; }

// The last line by which the program has named an error.
std::string last_error(const std::string& file) {
  constexpr std::string_view kOurs = "apothem: ", kWarning = "apothem: warning: ";
  std::string last;
  try {
    std::istringstream text(read_text(file));
    for (std::string line; std::getline(text, line);) {
      if (line.starts_with(kOurs) && !line.starts_with(kWarning)) last = line.substr(kOurs.size());
    }
  } catch (const SceneError&) {
    // Without its messages a run has failed all the same.
  }
  return last;
}

std::vector<std::string> command_of(const Study& study, const PlannedRun& run, bool resume) {
  std::vector<std::string> words{kProgramItself, "run", study.settings().scene};
  for (const Setting& s : study.settings_of(run)) {
    words.insert(words.end(), {"--set", s.text()});
  }
  words.insert(words.end(), {"-o", study.folder_of(run), "--threads", "1", "--quiet"});
  words.emplace_back(resume ? "--resume" : "--overwrite");
  if (!resume && !study.settings().from.empty()) {
    words.insert(words.end(), {"--from", study.from_of(run)});
  }
  return words;
}

}  // namespace

HeldSignals::HeldSignals() {
  sigemptyset(&held_);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&held_, signal);
  sigprocmask(SIG_BLOCK, &held_, &before_);
}

HeldSignals::~HeldSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

int HeldSignals::next() const {
  const timespec while_waiting{0, 200'000'000};
  return sigtimedwait(&held_, nullptr, &while_waiting);
}

RunPool::RunPool(const Study& study, int jobs, bool retry_failed)
    : study_(study), jobs_(static_cast<size_t>(jobs)), retry_failed_(retry_failed) {}

bool RunPool::work(const std::vector<const PlannedRun*>& runs,
                   const std::function<void(const Progress&)>& report) {
  const Clock::time_point begin = Clock::now();
  progress_.total = runs.size();
  size_t next = 0;
  while (true) {
    while (!interrupted_ && children_.size() < jobs_ && next < runs.size()) start(*runs[next++]);
    if (children_.empty()) break;
    const int signal = signals_.next();
    interrupted_ = interrupted_ || signal == SIGINT || signal == SIGTERM;
    for (const Child& child : children_) {
      if (interrupted_) kill(child.process, SIGINT);
    }
    collect();
    progress_.running = children_.size();
    progress_.seconds = seconds_since(begin);
    report(progress_);
  }
  return !interrupted_;
}

// The lock on the messages of a run is passed on to its process, so that it lasts as long as
// somebody works on the run, even if this process is killed.
void RunPool::start(const PlannedRun& run) {
  const std::string folder = study_.folder_of(run);
  create_folder(folder);
  const std::string file = messages_of(folder);
  const int messages = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (messages < 0) throw SystemFailure(file, errno);
  // Where the file system has no locks, runs are not guarded against a second study.
  const bool locked = flock(messages, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  const RunState state = study_.state_of(run);
  if (locked || state == RunState::done || (has_failed(state) && !retry_failed_)) {
    ::close(messages);
    ++progress_.skipped;
    return;
  }
  const bool resume =
      (state == RunState::interrupted || state == RunState::crashed || state == RunState::failed) &&
      has_checkpoint(folder);
  launch({&run, messages, resume, 0});
}

void RunPool::launch(Child child) {
  if (ftruncate(child.messages, 0) != 0) {
    throw SystemFailure(messages_of(study_.folder_of(*child.run)), errno);
  }
  study_.begin_run(*child.run, child.resumed);
  const int error = start_program(command_of(study_, *child.run, child.resumed), child.messages,
                                  child.messages, child.process);
  if (error != 0) {
    throw std::runtime_error(fmt::format("a run cannot be started: {}", std::strerror(error)));
  }
  children_.push_back(child);
}

void RunPool::collect() {
  std::vector<Child> ended;
  std::vector<int> statuses;
  for (size_t i = 0; i < children_.size();) {
    int status = 0;
    if (waitpid(children_[i].process, &status, WNOHANG) != children_[i].process) {
      ++i;
      continue;
    }
    ended.push_back(children_[i]);
    statuses.push_back(status);
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (size_t i = 0; i < ended.size(); ++i) {
    if (is_over(ended[i], statuses[i])) {
      ::close(ended[i].messages);
      continue;
    }
    // Its checkpoint was of no use: damaged, or of another version of the program.
    fmt::print(stderr, "apothem: {}: the run begins anew: {}\n", ended[i].run->key,
               last_error(messages_of(study_.folder_of(*ended[i].run))));
    ended[i].resumed = false;
    launch(ended[i]);
  }
}

// Notes how a process has ended; false if its run has to begin anew.
bool RunPool::is_over(const Child& child, int status) {
  RunEnding ending;
  if (WIFEXITED(status)) {
    ending.exit_code = WEXITSTATUS(status);
  } else if (interrupted_ && WTERMSIG(status) == SIGINT) {
    ending.exit_code = exit_code::interrupted;
  } else {
    ending.signal = WTERMSIG(status);
  }
  if (child.resumed && ending.exit_code == exit_code::bad_input && !interrupted_) return false;
  const bool done = ending.signal == 0 &&
                    (ending.exit_code == exit_code::done || ending.exit_code == exit_code::missed);
  const bool interrupted = ending.signal == 0 && ending.exit_code == exit_code::interrupted;
  if (ending.signal != 0) {
    ending.message =
        fmt::format("ended by signal {} ({})", ending.signal, strsignal(ending.signal));
  } else if (!done && !interrupted) {
    ending.message = last_error(messages_of(study_.folder_of(*child.run)));
    if (ending.message.empty()) ending.message = fmt::format("exit code {}", ending.exit_code);
  }
  study_.end_run(*child.run, ending);
  ++progress_.ended;
  if (!done && !interrupted) ++progress_.failed;
  return true;
}

}  // namespace apothem
