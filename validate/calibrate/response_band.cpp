#include "validate/calibrate/response_band.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/in_parallel.hpp"
#include "validate/fit/sensitivities.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::calibrate {

ResponseBands response_bands(const plant::PlantModel& fitted, const std::vector<record::Record>& records,
                             const std::vector<fit::FreeParameter>& free, const CalibrateOptions& options) {
  const std::vector<bool> out = held_out_events(records, options.held_out);
  const noise::WhitenedEvents events = noise::whitened_events(fitted, records, options.events);
  const sim::plant::PlantUnderTest tested = fitted.under_test();
  std::vector<fit::LinearisedEvent> linear(events.size());
  std::vector<double> chi2(events.size());
  const auto each = [&](auto work) { in_parallel(events.size(), work, [](int) {}); };
  each([&](std::size_t e) {
    const fit::Fit alone = fit::fit(tested, events.alone(e), {});
    if (!alone.failed.empty()) throw event::playback_failure(events[e].record.name, alone.failed);
    chi2[e] = alone.chi2;
    linear[e] = fit::linearise(tested, events.whitened(e), alone.events.front().state, free);
  });
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    precision(i, i) = free[static_cast<std::size_t>(i)].prior_sd > 0 ? 1 : 0;
  double sum = 0, values = 0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    if (out[e]) continue;
    const Eigen::MatrixXd j = linear[e].projected();
    precision += j.transpose() * j;
    sum += chi2[e];
    values += events[e].values();
  }
  const Eigen::MatrixXd covariance = precision.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  const double half = constants::normal95 * std::sqrt(std::max(1.0, sum / values));
  ResponseBands bands(events.size());
  each([&](std::size_t e) {
    auto deviation = fit::response_deviation(linear[e], events[e], covariance);
    for (std::size_t c = 0; c < deviation.size(); ++c) {
      for (double& v : deviation[c]) v *= half;
      bands[e].emplace(playin::output_name(events[e].channels[c]), std::move(deviation[c]));
    }
  });
  return bands;
}

}  // namespace swingbank::validate::calibrate
