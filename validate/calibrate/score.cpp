// Reduced chi-square of events, its limit for noise alone, and the choice of events and parameters.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "validate/calibrate/calibrate.hpp"
#include "validate/playin/instruments.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::calibrate {
namespace {

constexpr int kLags = 10;  ///< largest lag of the noise's autocorrelation [samples]

/// Returns the autocorrelation of the whitened pre-event residual at lags 1..kLags, pooled over the channels.
std::vector<double> correlations(const event::FitEvent& event, const fit::EventFit& fitted) {
  std::vector<double> sums(kLags + 1, 0.0);
  const int n = std::min(event.start.samples, event.record.samples());
  for (const auto& channel : fitted.residual) {
    double mean = 0;
    for (int k = 0; k < n; ++k) mean += channel[static_cast<std::size_t>(k)] / n;
    for (int lag = 0; lag <= kLags; ++lag)
      for (int k = lag; k < n; ++k)
        sums[static_cast<std::size_t>(lag)] += (channel[static_cast<std::size_t>(k)] - mean) *
                                               (channel[static_cast<std::size_t>(k - lag)] - mean);
  }
  std::vector<double> rho;
  for (int lag = 1; lag <= kLags; ++lag)
    rho.push_back(sums[0] > 0 ? sums[static_cast<std::size_t>(lag)] / sums[0] : 0.0);
  return rho;
}

/// Returns the RMS of model - measured over the compared samples [pu].
double rms(const event::FitEvent& event, const fit::EventFit& fitted, std::size_t c) {
  const auto& measured = event.measured(event.channels[c]);
  double sum = 0;
  int compared = 0;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!event.compared(k)) continue;
    sum += std::pow(fitted.model[c][k] - measured[k], 2);
    ++compared;
  }
  return std::sqrt(sum / compared);
}

}  // namespace

double reduced_chi2_limit(const event::FitEvent& event, const fit::EventFit& fitted, int pre_event,
                          double least) {
  double variance_ratio =
      1;  // variance of a sum of squares of coloured noise / that of white noise (Bartlett)
  const int n = std::max(2, event.start.samples);
  for (const double r : correlations(event, fitted))
    variance_ratio += 2 * std::max(0.0, r * r - 1.0 / n);  // 1/n: expectation of r^2 for white noise
  const double samples = 2 * variance_ratio / event.values();
  const double estimate =
      2 * variance_ratio / (static_cast<double>(event.channels.size()) * std::max(1, pre_event - 1));
  return thresholds::event_limit(std::sqrt(samples + estimate), least);
}

int pre_event_samples(const noise::WhitenedEvents& events) {
  int sum = 0;
  for (const auto& e : events) sum += e.start.samples - 1;
  return sum;
}

double unseen_allowance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance, int values) {
  // chi2 = |J d + e|^2 for a parameter error d and white noise e
  const Eigen::MatrixXd form = information * covariance;
  const double mean = form.trace(), variance = 2 * (form * form).trace() + 4 * mean;
  return (mean + thresholds::adequacy.one_in_thousand * std::sqrt(std::max(variance, 0.0))) / values;
}

std::string residual_text(const std::vector<EventScore>& events) {
  const auto of_noise = [](const EventScore& e) { return e.after / (e.limit - e.allowance); };
  const auto most = std::ranges::max_element(events, {}, of_noise);
  if (most == events.end() || most->is_noise()) return "the residual is noise";
  return fmt::format(
      "the residual is within noise and the uncertainty of the fitted parameters ({}: reduced chi-square {:.3g}, "
      "limit {:.3g}, for noise alone {:.3g})",
      most->record, most->after, most->limit, most->limit - most->allowance);
}

EventScore score_event(noise::WhitenedEvent whitened, const fit::EventFit& before, const fit::EventFit& after,
                       bool seen, int pre_event, double least) {
  const event::FitEvent& event = whitened.event;
  EventScore s;
  s.record = event.record.name;
  s.seen = seen;
  noise::require_same(before.noise, after.noise);
  s.before = before.reduced_chi2();
  s.after = after.reduced_chi2();
  s.limit = reduced_chi2_limit(event, after, pre_event, least);
  s.colour = correlations(event, after).front();
  for (std::size_t c = 0; c < event.channels.size(); ++c) {
    ChannelScore channel;
    channel.channel = event.channels[c];
    const bool reactive = channel.channel == playin::Output::Q;
    const bool power =
        reactive || channel.channel == playin::Output::P || channel.channel == playin::Output::Pm;
    channel.unit = !power ? "pu" : reactive ? "Mvar" : "MW";
    channel.scale = power ? event.record.base.mva : 1.0;
    const double noise = whitened.noise.deviation[static_cast<Eigen::Index>(c)];
    channel.rms_before = channel.scale * rms(event, before, c);
    channel.rms_after = channel.scale * rms(event, after, c);
    channel.over_noise = channel.rms_after / (channel.scale * noise);
    s.channels.push_back(channel);
  }
  return s;
}

std::vector<bool> held_out_events(const std::vector<record::Record>& records,
                                  const std::vector<std::string>& names) {
  std::vector<bool> out(records.size(), false);
  Problems problems;
  std::string all;
  for (const auto& r : records) all += (all.empty() ? "" : ", ") + r.name;
  for (const auto& name : names) {
    bool found = false;
    for (std::size_t k = 0; k < records.size(); ++k)
      if (name == records[k].name || name == std::filesystem::path(records[k].name).stem().string() ||
          name == std::to_string(k + 1))
        out[k] = found = true;
    if (!found)
      problems.add("event '" + name + "'", "--hold-out", "no record has that name or number",
                   "use one of " + all + ", or a number from 1 to " + std::to_string(records.size()));
  }
  if (records.empty())
    problems.add("no record", "--records", "there is nothing to fit", "give at least one event");
  else if (std::ranges::count(out, false) == 0)
    problems.add("every event is held out", "--hold-out", "no event remains for the fit",
                 records.size() == 1 ? "give more records" : "remove at least one --hold-out");
  problems.raise();
  return out;
}

std::vector<record::Record> seen_records(const std::vector<record::Record>& records,
                                         const std::vector<std::string>& held_out) {
  const auto out = held_out_events(records, held_out);
  std::vector<record::Record> seen;
  for (std::size_t k = 0; k < records.size(); ++k)
    if (!out[k]) seen.push_back(records[k]);
  return seen;
}

std::vector<fit::FreeParameter> chosen_parameters(const sim::plant::Plant& plant, double prior_sd,
                                                  const std::vector<std::string>& fixed) {
  std::vector<fit::FreeParameter> free = fit::free_parameters(plant, prior_sd);
  for (int block = sim::plant::first_measurement(plant); block < sim::plant::block_count(plant); ++block)
    if (playin::can_be_taken_back(sim::plant::block_effect(plant, block)))
      std::ranges::copy(fit::free_parameters(plant, block, prior_sd), std::back_inserter(free));
  Problems problems;
  std::vector<sim::plant::ParameterId> ids;
  for (const auto& f : free) ids.push_back(f.id);
  const auto held = sim::plant::find_parameters(plant, ids, fixed, "--fix",
                                                "the model has no free parameter of this name", problems);
  std::erase_if(free, [&](const fit::FreeParameter& f) { return std::ranges::count(held, f.id) > 0; });
  if (free.empty() && problems.empty())
    problems.add("no free parameter", plant.name, "all are fixed, zero, at a null value, or codes",
                 "leave some free");
  problems.raise();
  return free;
}

}  // namespace swingbank::validate::calibrate
