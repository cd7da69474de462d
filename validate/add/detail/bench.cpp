#include "validate/add/detail/bench.hpp"

#include "base/in_parallel.hpp"
#include "validate/hypothesis/judge.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {

Bench::Bench(const plant::PlantModel& model, std::vector<record::Record> records,
             const calibrate::CalibrateOptions& options)
    : options_(options), out_(calibrate::held_out_events(records, options.held_out)) {
  all_ = noise::whitened_events(model, std::move(records), options.events);
  keep_seen();
}

bool Bench::measure_noise(const fit::Fit& seen, const sim::Conventions& conventions) {
  if (seen.reduced_chi2() >= thresholds::noise.measurable) return false;
  const sim::plant::PlantUnderTest fitted{seen.plant, conventions};
  all_ = all_.with(noise::measure_noise_through(fitted, each(fitted, event::Phase::noise_again),
                                                seen.reduced_chi2(), all_));
  keep_seen();
  return true;
}

std::vector<fit::EventFit> Bench::each(const sim::plant::PlantUnderTest& tested, event::Phase phase) const {
  std::vector<fit::EventFit> fits(all_.size());
  in_parallel(
      all_.size(),
      [&](std::size_t e) {
        fit::Fit f = fit::fit(tested, all_.alone(e), {});
        if (!f.failed.empty()) throw event::playback_failure(all_[e].record.name, f.failed);
        fits[e] = std::move(f.events.front());
      },
      [&](int done) { report_progress(phase, done); });
  return fits;
}

std::vector<fit::EventState> Bench::states_of(const std::vector<fit::EventFit>& fits) const {
  std::vector<fit::EventState> states;
  for (std::size_t e = 0; e < fits.size(); ++e)
    if (is_seen(e)) states.push_back(fits[e].state);
  return states;
}

fit::Fit Bench::go_on(const hypothesis::Hypothesis& h, const fit::Fit& f) const {
  const auto free = hypothesis::free_of(h, options_.prior_sd);
  return fit::fit(h.under_test(), seen_, free, fit::continued({}, f, free));
}

void Bench::report_progress(event::Phase phase, int done) const {
  if (options_.progress) options_.progress(phase, "", done, static_cast<int>(all_.size()));
}

void Bench::keep_seen() {
  std::vector<std::size_t> seen;
  for (std::size_t e = 0; e < all_.size(); ++e)
    if (is_seen(e)) seen.push_back(e);
  seen_ = all_.only(seen);
}

}  // namespace swingbank::validate::add
