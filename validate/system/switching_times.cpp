// Estimation of the switching times of a system comparison from its records.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/golden_section.hpp"
#include "sim/plant/measure.hpp"
#include "validate/event/event.hpp"
#include "validate/switching/voltage_steps.hpp"
#include "validate/system/detail/run.hpp"

namespace swingbank::validate::system {
namespace {

constexpr double kAfterLast = 1.0;  // duration of the fit after the last switching [s]

/// Returns the voltage steps of one record.
std::vector<switching::Switching> find_voltage_steps(const record::Record& r) {
  return switching::VoltageSteps(r).find(switching::kStepThreshold, switching::StepShape::either).switchings;
}

/// Returns the case with its records cut off after `end` [s].
SystemCase shortened(SystemCase s, double end) {
  for (auto& t : s.terminals) {
    record::Record& r = t.record;
    const auto kept = static_cast<std::size_t>(std::ranges::upper_bound(r.t, end) - r.t.begin());
    for (auto* channel :
         {&r.t, &r.V, &r.theta, &r.P, &r.Q, &r.f, &r.speed, &r.Efd, &r.Ifd, &r.theta_as_written})
      if (!channel->empty()) channel->resize(std::max<std::size_t>(kept, 2));
  }
  return s;
}

class SwitchingTimeFit {
 public:
  SwitchingTimeFit(const SystemCase& system, std::vector<double> written, std::vector<double> found)
      : s_(shortened(system, found.back() + kAfterLast)),
        written_(std::move(written)),
        best_(std::move(found)) {
    mark_filtered();
  }

  /// Golden-section search for each switching time in turn, within `reach` [s] of its detected value.
  std::vector<double> run(double reach) {
    constexpr int kSweeps = 2, kSteps = 9;  // 9 steps leave 1.3 % of the interval
    constexpr double kEnough = 2.5e-4;      // [s]; required for the long intervals behind a filter
    const auto middle = best_;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::size_t k = 0; k < best_.size(); ++k) {
        double low = middle[k] - reach, high = middle[k] + reach;
        if (k > 0) low = std::max(low, best_[k - 1] + 1e-4);
        if (k + 1 < best_.size()) high = std::min(high, best_[k + 1] - 1e-4);
        best_[k] = golden_section([&](double at) { return sum_of_squares(k, at); }, low, high,
                                  [](int step, double width) { return step < kSteps || width > kEnough; })
                       .at;
      }
    return best_;
  }

 private:
  void mark_filtered() {
    const auto declared = [](const SystemTerminal& t) { return sim::plant::memory(t.instruments) > 0; };
    std::vector<record::Record> records;
    for (const SystemTerminal& t : s_.terminals)
      if (!declared(t)) records.push_back(t.record);
    const switching::StepShape step_shape = switching::step_shape_of(records, switching::kStepThreshold);
    for (const SystemTerminal& t : s_.terminals) {
      filtered_samples_.emplace_back(t.record.t.size(), 0);
      if (!declared(t) && step_shape == switching::StepShape::filtered)
        filtered_samples_.back() = switching::VoltageSteps(t.record)
                                       .find(switching::kStepThreshold / 2, step_shape)
                                       .filtered_samples;
    }
  }
  /// Returns the sum of the squared residuals of V, P and Q of all terminals for switching time k at t [s].
  /// Each residual is taken relative to its mean before the event, and divided by its standard deviation
  /// before the event.
  double sum_of_squares(std::size_t k, double t) {
    auto switching_times = best_;
    switching_times[k] = t;
    const SystemRun run = run_system(s_, moved(s_.event, written_, switching_times));
    double sum = 0;
    for (std::size_t i = 0; i < s_.terminals.size(); ++i) {
      const record::Record& r = s_.terminals[i].record;
      const Modelled& m = run.responses[i];
      const auto of = [&](const std::vector<double>& measured, const std::vector<double>& modelled) {
        return squares(r.t, measured, modelled, filtered_samples_[i]);
      };
      sum += of(r.V, m.V) + of(r.P, m.P) + of(r.Q, m.Q);
    }
    return sum;
  }
  [[nodiscard]] double squares(const std::vector<double>& t, const std::vector<double>& measured,
                               const std::vector<double>& modelled,
                               const std::vector<char>& filtered_samples) const {
    if (measured.empty()) return 0;
    const auto quiet = static_cast<std::size_t>(
        std::max<std::ptrdiff_t>(std::ranges::lower_bound(t, best_.front() - 0.05) - t.begin(), 2));
    double mean = 0, variance = 0, sum = 0;
    for (std::size_t k = 0; k < quiet; ++k) mean += (modelled[k] - measured[k]) / static_cast<double>(quiet);
    for (std::size_t k = 0; k < quiet; ++k)
      variance += std::pow(modelled[k] - measured[k] - mean, 2) / static_cast<double>(quiet);
    for (std::size_t k = 0; k < t.size(); ++k)
      if (!filtered_samples[k]) sum += std::pow(modelled[k] - measured[k] - mean, 2);
    return sum / (variance + switching::kLeastNoise * switching::kLeastNoise);
  }

  SystemCase s_;
  std::vector<double> written_, best_;
  /// Per terminal: samples within steps filtered by an undeclared filter, which no switching time can fit.
  std::vector<std::vector<char>> filtered_samples_;
};

}  // namespace

std::vector<double> estimate_switching_times(const SystemCase& s, double& uncertainty) {
  const auto written = switching_times_of(s.event);
  std::vector<double> sum(written.size(), 0.0);
  int votes = 0;
  std::string counts;
  uncertainty = 0;
  for (const auto& t : s.terminals) {
    const auto voltage_steps = find_voltage_steps(t.record);
    counts += fmt::format("{}{} in {}", counts.empty() ? "" : ", ", voltage_steps.size(), t.name);
    if (voltage_steps.size() != written.size()) continue;
    ++votes;
    for (std::size_t k = 0; k < voltage_steps.size(); ++k) {
      sum[k] += voltage_steps[k].time;
      uncertainty = std::max(uncertainty, voltage_steps[k].uncertainty);
    }
  }
  if (votes == 0)
    throw InputError({fmt::format("{} switching times", written.size()),
                      s.file.string() + ", event.switching_times",
                      "no record has this number of voltage steps (" + counts + ")",
                      "give the switching times (event.switching_times = \"given\")"});
  for (double& t : sum) t /= votes;
  return SwitchingTimeFit(s, written, sum).run(uncertainty);
}

std::string clock_doubt(const record::Record& record, const std::vector<double>& switching_times) {
  const auto voltage_steps = find_voltage_steps(record);
  if (voltage_steps.size() != switching_times.size()) return {};
  constexpr double kSlack = 1e-3;  // tolerance of time stamps [s]
  bool off = false;
  std::string seen;
  for (std::size_t k = 0; k < voltage_steps.size(); ++k) {
    off = off || std::abs(voltage_steps[k].time - switching_times[k]) > voltage_steps[k].uncertainty + kSlack;
    seen += fmt::format("{}{:.4f} s", seen.empty() ? "" : ", ", voltage_steps[k].time);
  }
  if (!off) return {};
  return fmt::format(
      "The voltage of {} has steps at {} (± {:.1f} ms), not at the event's switching times: "
      "check its clock, or estimate the times from the records (event.switching_times = \"found\").",
      record.name, seen, 1e3 * voltage_steps.front().uncertainty);
}

}  // namespace swingbank::validate::system
