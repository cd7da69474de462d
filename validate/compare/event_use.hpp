#pragma once
// Use of each event in a report: comparison, fit, or verification of the fit.
#include <string>
#include <vector>

namespace swingbank::validate::compare {

/// Events to which parameters were fitted, and independent events that verify the fit.
struct EventUse {
  bool fitted = false;                     ///< parameters were fitted; false: all events are compared only
  std::vector<std::string> held_out = {};  ///< names of the records excluded from the fit
  /// Returns the use of a record: "comparison", "fit" or "verification".
  [[nodiscard]] std::string of(const std::string& record) const;
  /// Returns a sentence with the number of events of the fit and the names of the events that verify it, if
  /// any; empty without a fit.
  [[nodiscard]] std::string sentence(const std::vector<std::string>& records) const;
};

}  // namespace swingbank::validate::compare
