#include "apps/polygon/batch.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <thread>
#include <vector>

#include "apps/commands.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {
namespace {

// Lines per thread that are read before they are evaluated: enough that nobody waits for long.
constexpr size_t kLinesEach = 16;
constexpr double kLineTime = 1e6;  // ns, roughly

class Answers {
 public:
  explicit Answers(const std::function<BatchAnswer(const BatchLine&)>& evaluate)
      : evaluate_(evaluate), threads_(static_cast<int>(std::thread::hardware_concurrency())) {}

  void add(const BatchLine& line) {
    lines_.push_back(line);
    if (lines_.size() >= kLinesEach * static_cast<size_t>(threads_.count())) print();
  }

  void print() {
    struct Result {
      BatchAnswer answer;
      std::exception_ptr failure;
    };
    std::vector<Result> results(lines_.size());
    threads_.each(static_cast<int>(lines_.size()), kLineTime, [&](int i) {
      try {
        results[i].answer = evaluate_(lines_[i]);
      } catch (...) {
        results[i].failure = std::current_exception();
      }
    });
    lines_.clear();
    for (const auto& [answer, failure] : results) {
      if (failure) std::rethrow_exception(failure);
      fmt::print("{}\n", answer.text);
      refused_ = refused_ || answer.refused;
    }
  }

  [[nodiscard]] bool any_refused() const { return refused_; }

 private:
  const std::function<BatchAnswer(const BatchLine&)>& evaluate_;
  Threads threads_;
  std::vector<BatchLine> lines_;
  bool refused_ = false;
};

}  // namespace

int print_answers(const std::string& file, const char* form,
                  const std::function<BatchAnswer(const BatchLine&)>& evaluate) {
  Answers answers(evaluate);
  for_each_line(file, form, [&](const BatchLine& line) { answers.add(line); });
  answers.print();
  return answers.any_refused() ? exit_code::bad_input : exit_code::done;
}

}  // namespace apothem
