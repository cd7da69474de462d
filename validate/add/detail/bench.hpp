#pragma once
// Events of an addition with their noise: all of them, and those that the fits use.
#include <vector>

#include "validate/calibrate/calibrate.hpp"
#include "validate/hypothesis/hypothesis.hpp"

namespace swingbank::validate::add {

/// Prepared events of an addition, and the subset that is not held out.
class Bench {
 public:
  /// Prepares the events. Throws InputError in the same cases as calibrate().
  Bench(const plant::PlantModel& model, std::vector<record::Record> records,
        const calibrate::CalibrateOptions& options);
  [[nodiscard]] const noise::WhitenedEvents& all() const { return all_; }
  [[nodiscard]] const noise::WhitenedEvents& seen() const { return seen_; }
  [[nodiscard]] bool is_seen(std::size_t e) const { return !out_[e]; }
  /// Estimates the noise again from the residuals of a fit to the seen events. Returns false and changes
  /// nothing if the fit's reduced chi-square is too high.
  bool measure_noise(const fit::Fit& seen, const sim::Conventions& conventions);
  /// Fits the state of every event by itself, at fixed parameters. Throws InputError if a playback fails.
  [[nodiscard]] std::vector<fit::EventFit> each(const sim::plant::PlantUnderTest& tested,
                                                event::Phase phase) const;
  /// Returns the states of the seen events.
  [[nodiscard]] std::vector<fit::EventState> states_of(const std::vector<fit::EventFit>& fits) const;
  /// Continues the fit `f` of a hypothesis to the seen events from its end.
  [[nodiscard]] fit::Fit go_on(const hypothesis::Hypothesis& h, const fit::Fit& f) const;
  void report_progress(event::Phase phase, int done) const;

 private:
  void keep_seen();

  const calibrate::CalibrateOptions& options_;
  std::vector<bool> out_;  ///< whether each event is held out
  noise::WhitenedEvents all_, seen_;
};

}  // namespace swingbank::validate::add
