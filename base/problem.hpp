#pragma once
// What is wrong with an input, where, why, and what to do about it. All problems of one input are
// collected and thrown together, so that a person mends them in one go.
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank {

/// Text of a user's file or name as it may be shown: control characters and bytes that are no UTF-8 are
/// escaped, so that a terminal does what it did before, and a text of more than 1,000 bytes is cut.
std::string shown(std::string_view text);

/// One sentence to the user: "<what> at <where> (<why>): <remedy>".
struct Problem {
  std::string what, where, why, remedy;
  [[nodiscard]] std::string sentence() const {
    return shown(what) + " at " + shown(where) + " (" + shown(why) + "): " + shown(remedy);
  }
};

/// Thrown with every problem of one input; what() holds one sentence per line.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Problem> problems)
      : std::runtime_error(text(problems)), problems_(std::move(problems)) {}
  explicit InputError(Problem problem) : InputError(std::vector<Problem>{std::move(problem)}) {}
  [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

 private:
  static std::string text(const std::vector<Problem>& problems) {
    std::string all;
    for (const auto& p : problems) all += (all.empty() ? "" : "\n") + p.sentence();
    return all;
  }
  std::vector<Problem> problems_;
};

/// Collects problems while an input is read; `raise()` throws them together if there are any.
class Problems {
 public:
  void add(std::string what, std::string where, std::string why, std::string remedy) {
    list_.push_back({std::move(what), std::move(where), std::move(why), std::move(remedy)});
  }
  void add(const Problems& other) { list_.insert(list_.end(), other.list_.begin(), other.list_.end()); }
  [[nodiscard]] bool empty() const { return list_.empty(); }
  [[nodiscard]] const std::vector<Problem>& list() const { return list_; }
  void raise() const {
    if (!list_.empty()) throw InputError(list_);
  }

 private:
  std::vector<Problem> list_;
};

}  // namespace swingbank
