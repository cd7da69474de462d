#pragma once
// Findings on one record; only the first of each kind is kept, because the checks run in order of certainty.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "validate/check/check.hpp"

namespace swingbank::validate::check {

class Findings {
 public:
  explicit Findings(std::string record) : record_(std::move(record)) {}

  void add(Finding finding) {
    if (!found(finding.kind)) all_.push_back(std::move(finding));
  }
  void add(std::string kind, Severity severity, std::string what, std::string why, std::string remedy) {
    add({std::move(kind), severity, {std::move(what), record_, std::move(why), std::move(remedy)}});
  }
  void refuse(std::string kind, std::string what, std::string why, std::string remedy) {
    add(std::move(kind), Severity::refuse, std::move(what), std::move(why), std::move(remedy));
  }
  void warn(std::string kind, std::string what, std::string why, std::string remedy) {
    add(std::move(kind), Severity::warn, std::move(what), std::move(why), std::move(remedy));
  }
  [[nodiscard]] bool found(std::string_view kind) const {
    return std::ranges::find(all_, kind, &Finding::kind) != all_.end();
  }
  [[nodiscard]] bool none() const { return all_.empty(); }
  /// Moves the findings out, refusals first.
  std::vector<Finding> taken() {
    std::ranges::stable_sort(all_, {}, &Finding::severity);
    return std::move(all_);
  }

 private:
  std::string record_;
  std::vector<Finding> all_;
};

}  // namespace swingbank::validate::check
