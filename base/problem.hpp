#pragma once
// Problems of an input: what is wrong, where, why, and the remedy. All problems of one input are collected
// and thrown together, so that the user can correct them at once.
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank {

/// Returns a text from a user's file or path in a form that is safe to print. Escapes control characters and
/// bytes that are not UTF-8, so that they cannot change the terminal's state, and cuts texts after 1,000
/// bytes.
std::string shown(std::string_view text);

/// One sentence to the user: "<what> at <where> (<why>): <remedy>".
struct Problem {
  std::string what, where, why, remedy;  ///< defect; file and line, or option; reason; what to do
  /// Returns the sentence, with control characters made visible by shown().
  [[nodiscard]] std::string sentence() const {
    return shown(what) + " at " + shown(where) + " (" + shown(why) + "): " + shown(remedy);
  }
};

/// Exception with all problems of one input; what() has one sentence per line.
class InputError : public std::runtime_error {
 public:
  /// Constructs the exception from all problems of an input.
  explicit InputError(std::vector<Problem> problems)
      : std::runtime_error(text(problems)), problems_(std::move(problems)) {}
  /// Constructs the exception from one problem.
  explicit InputError(Problem problem) : InputError(std::vector<Problem>{std::move(problem)}) {}
  /// Returns the problems.
  [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

 private:
  static std::string text(const std::vector<Problem>& problems) {
    std::string all;
    for (const auto& p : problems) all += (all.empty() ? "" : "\n") + p.sentence();
    return all;
  }
  std::vector<Problem> problems_;
};

/// Collector of problems while an input is read; `raise()` throws all of them as one InputError, if any.
class Problems {
 public:
  /// Adds a problem from the parts of its sentence.
  void add(std::string what, std::string where, std::string why, std::string remedy) {
    list_.push_back({std::move(what), std::move(where), std::move(why), std::move(remedy)});
  }
  /// Adds all problems of an exception.
  void add(const InputError& error) {
    list_.insert(list_.end(), error.problems().begin(), error.problems().end());
  }
  /// Adds all problems of another collector.
  void add(const Problems& other) { list_.insert(list_.end(), other.list_.begin(), other.list_.end()); }
  /// Whether no problem was added.
  [[nodiscard]] bool empty() const { return list_.empty(); }
  /// Returns the problems, in the order of their addition.
  [[nodiscard]] const std::vector<Problem>& list() const { return list_; }
  /// Throws InputError with all problems, if there are any.
  void raise() const {
    if (!list_.empty()) throw InputError(list_);
  }

 private:
  std::vector<Problem> list_;
};

}  // namespace swingbank
