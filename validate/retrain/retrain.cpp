#include "validate/retrain/retrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/plant/usual.hpp"
#include "validate/calibrate/report.hpp"

namespace swingbank::validate::retrain {
namespace {

using nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr const char* kSides[2] = {"without", "with"};

const calibrate::NetworkEstimate::Parameter* find(const calibrate::NetworkEstimate& e,
                                                  const std::string& full) {
  const auto at = std::ranges::find_if(e.parameters, [&](const auto& p) { return p.full() == full; });
  return at == e.parameters.end() ? nullptr : &*at;
}

/// Returns the reference values: the true values if known, otherwise the fitted values.
calibrate::Truth reference_of(const add::Addition& added, const calibrate::Truth& truth) {
  if (!truth.empty()) return truth;
  calibrate::Truth fitted;
  for (const auto& p : added.parameters) fitted[p.full_name()] = p.value;
  return fitted;
}

/// Returns the parameters with a reference value: first those that both networks estimate, then those of the
/// effect.
std::vector<RetrainedParameter> parameters_of(const std::array<calibrate::NetworkEstimate, 2>& estimates,
                                              const calibrate::Truth& reference) {
  std::vector<RetrainedParameter> all;
  for (const auto& p : estimates[1].parameters) {
    const auto known = reference.find(p.full());
    if (!p.learnt() || known == reference.end()) continue;
    RetrainedParameter r;
    r.name = p.full();
    r.unit = p.unit;
    r.reference = known->second;
    r.deviation = (p.high - p.low) / std::sqrt(12.0);
    r.middle = std::abs((p.high + p.low) / 2 - r.reference) / r.deviation;
    const auto* other = find(estimates[0], r.name);
    r.own = other == nullptr || !other->learnt();
    all.push_back(r);
  }
  std::ranges::stable_sort(all, {}, &RetrainedParameter::own);
  return all;
}

double estimate_of(const calibrate::NetworkEstimate& e, std::size_t record, const std::string& full) {
  const auto* p = find(e, full);
  return p ? e.records[record].values[static_cast<std::size_t>(p - e.parameters.data())]
           : std::numeric_limits<double>::quiet_NaN();
}

/// Returns the model with a network's estimates, averaged over the fitted events.
sim::plant::Plant seen_plant(const calibrate::NetworkEstimate& e, const plant::PlantModel& model,
                             const std::vector<RetrainedEvent>& events) {
  sim::plant::Plant plant = model.plant;
  for (int block = 0; block < sim::plant::first_measurement(plant); ++block) {
    for (const sim::plant::ParameterId id : sim::plant::parameters_of(plant, block)) {
      const auto* p = find(e, sim::plant::parameter_name(plant, id).text());
      if (p == nullptr || !p->learnt()) continue;
      double sum = 0;
      int n = 0;
      for (std::size_t k = 0; k < events.size(); ++k) {
        if (!events[k].seen) continue;
        sum += estimate_of(e, k, p->full());
        ++n;
      }
      double& value = sim::plant::parameter_value(plant, id);
      const auto [low, high] = sim::plant::search_range(sim::plant::parameter_record(plant, id), value);
      if (n > 0) value = std::clamp(sum / n, low, high);
    }
  }
  return plant;
}

/// Computes reduced chi-square and RMS error of P and Q [MW, Mvar] of one event, with its state fitted.
void leave(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& alone, double& reduced_chi2,
           double& rms) {
  reduced_chi2 = rms = kInfinity;
  const fit::Fit own = fit::fit(tested, alone, {});
  if (!own.failed.empty()) return;
  reduced_chi2 = own.reduced_chi2();
  const event::FitEvent& event = alone.front();
  const auto& model = own.events.front().model;
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t c = 0; c < 2; ++c) {  // P and Q are the first channels
    const auto& measured = event.measured(event.channels[c]);
    for (std::size_t k = 0; k < measured.size(); ++k, ++n) sum += std::pow(model[c][k] - measured[k], 2);
  }
  rms = event.record.base.mva * std::sqrt(sum / static_cast<double>(n));
}

std::string figure(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "cannot be simulated";
}
std::string power(double rms) {
  return std::isfinite(rms) ? fmt::format("{:.3g} MW, Mvar", rms) : "cannot be simulated";
}

std::string sentence_of(const Retrained& r, const add::Addition& added) {
  std::string text = fmt::format(
      "On held-out events the network without {} estimates the {} with an error of {:.3g} "
      "standard deviations of the drawn values; the network with it has an error of {:.3g}, {} by a factor of "
      "{:.3g} (midpoint of the intervals: {:.3g}).",
      added.hypothesis.name, r.truth ? "true parameters" : "fitted parameters", r.error[0], r.error[1],
      r.fall() < 1 ? "larger" : "smaller", r.fall() < 1 ? 1 / r.fall() : r.fall(), r.middle);
  if (r.error[1] > r.middle)
    text +=
        " This is no better than the midpoint: train the network with more data (--train-draws, --train-epochs).";
  text += fmt::format(" With the estimates of the network with {} ", added.hypothesis.name);
  if (!std::isfinite(r.rms[1])) return text + "the plant cannot be simulated.";
  return text +
         fmt::format("the RMS error of P and Q is {}; with the estimates of the other network {}.",
                     power(r.rms[1]),
                     std::isfinite(r.rms[0]) ? "it is " + power(r.rms[0]) : "the plant cannot be simulated");
}

}  // namespace

Retrained compare_networks(const std::array<calibrate::NetworkEstimate, 2>& estimates,
                           const plant::PlantModel& before, const add::Addition& added,
                           const calibrate::Truth& truth) {
  Retrained r;
  r.truth = !truth.empty();
  r.parameters = parameters_of(estimates, reference_of(added, truth));
  const auto shared = std::ranges::count(r.parameters, false, &RetrainedParameter::own);
  for (const auto& e : added.events) r.events.push_back({e.score.record, e.score.seen});
  const auto unseen = std::ranges::count(r.events, false, &RetrainedEvent::seen);
  Problems problems;
  if (unseen == 0)
    problems.add("no event held out", "--retrain", "networks are evaluated on held-out events",
                 "hold out at least one with --hold-out");
  if (shared == 0)
    problems.add("no parameter that both networks learnt", estimates[0].network, "nothing can be compared",
                 "vary the machine's parameters in the dataset config");
  problems.raise();
  for (auto& p : r.parameters)
    for (std::size_t side = p.own ? 1 : 0; side < 2; ++side)
      for (std::size_t e = 0; e < r.events.size(); ++e) {
        const double value = estimate_of(estimates[side], e, p.name);
        const double square = std::pow((value - p.reference) / p.deviation, 2);
        if (!p.own) r.events[e].parameter_error[side] += square / static_cast<double>(shared);
        if (r.events[e].seen) continue;
        p.estimate[side] += value / static_cast<double>(unseen);
        p.error[side] += square / static_cast<double>(unseen);
        if (!p.own) r.error[side] += square / static_cast<double>(unseen * shared);
      }
  for (auto& p : r.parameters) {
    for (auto& e : p.error) e = std::sqrt(e);
    if (!p.own) r.middle += p.middle * p.middle / static_cast<double>(shared);
  }
  r.middle = std::sqrt(r.middle);
  for (auto& e : r.error) e = std::sqrt(e);
  const sim::plant::Plant plants[2] = {seen_plant(estimates[0], before, r.events),
                                       seen_plant(estimates[1], added.model, r.events)};
  const sim::Conventions conventions[2] = {before.conventions, added.model.conventions};
  for (std::size_t e = 0; e < r.events.size(); ++e)
    for (std::size_t side = 0; side < 2; ++side) {
      auto& event = r.events[e];
      event.parameter_error[side] = std::sqrt(event.parameter_error[side]);
      leave({plants[side], conventions[side]}, added.prepared.alone(e), event.reduced_chi2[side],
            event.rms[side]);
      if (!event.seen) r.rms[side] += event.rms[side] * event.rms[side] / static_cast<double>(unseen);
    }
  for (auto& rms : r.rms) rms = std::sqrt(rms);
  r.sentence = sentence_of(r, added);
  return r;
}

std::string terminal_report(const Retrained& r) {
  report::Table t{"Networks",
                  {"parameter", "unit", r.truth ? "truth" : "fitted", "without", "error", "with", "error",
                   "midpoint error"},
                  {}};
  for (const auto& p : r.parameters)
    t.rows.push_back({p.name, p.unit, fmt::format("{:.4g}", p.reference),
                      p.own ? std::string() : fmt::format("{:.4g}", p.estimate[0]),
                      p.own ? std::string() : fmt::format("{:.2f}", p.error[0]),
                      fmt::format("{:.4g}", p.estimate[1]), fmt::format("{:.2f}", p.error[1]),
                      fmt::format("{:.2f}", p.middle)});
  t.rows.push_back({"rms of common parameters", "", "", "", fmt::format("{:.2f}", r.error[0]), "",
                    fmt::format("{:.2f}", r.error[1]), fmt::format("{:.2f}", r.middle)});
  report::Table events{"Events",
                       {"event", "", "parameter error without", "with", "P, Q rms without", "with",
                        "red. chi2 without", "with"},
                       {}};
  for (const auto& e : r.events)
    events.rows.push_back({e.record, e.seen ? "fitted" : "held out",
                           fmt::format("{:.2f}", e.parameter_error[0]),
                           fmt::format("{:.2f}", e.parameter_error[1]), power(e.rms[0]), power(e.rms[1]),
                           figure(e.reduced_chi2[0]), figure(e.reduced_chi2[1])});
  return r.sentence +
         "\n\nEstimates on held-out events; errors in standard deviations of the drawn values:\n" +
         report::padded(t, 1) +
         "\nP and Q with each network's estimates, averaged over the fitted events:\n" +
         report::padded(events, 1);
}

json retrained_json(const Retrained& r) {
  json j = {{"format", "swingbank-retrain-2"},
            {"sentence", r.sentence},
            {"reference", r.truth ? "truth" : "fitted"},
            {"parameter_error", {{"without", r.error[0]}, {"with", r.error[1]}, {"middle", r.middle}}},
            {"fall", r.fall()},
            {"rms_unseen_mw_mvar", {{"without", r.rms[0]}, {"with", r.rms[1]}}},
            {"parameters", json::array()},
            {"events", json::array()}};
  for (const auto& p : r.parameters) {
    json one = {{"parameter", p.name},      {"unit", p.unit}, {"reference", p.reference},
                {"deviation", p.deviation}, {"added", p.own}, {"middle_error", p.middle}};
    for (std::size_t side = p.own ? 1 : 0; side < 2; ++side)
      one[kSides[side]] = {{"estimate", p.estimate[side]}, {"error", p.error[side]}};
    j["parameters"].push_back(one);
  }
  for (const auto& e : r.events) {
    json one = {{"record", e.record}, {"seen", e.seen}};
    for (std::size_t side = 0; side < 2; ++side)
      one[kSides[side]] = {{"parameter_error", e.parameter_error[side]},
                           {"rms_mw_mvar", e.rms[side]},
                           {"reduced_chi2", e.reduced_chi2[side]}};
    j["events"].push_back(one);
  }
  return j;
}

}  // namespace swingbank::validate::retrain
