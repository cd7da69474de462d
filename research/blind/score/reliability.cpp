#include "research/blind/score/reliability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>

#include "validate/thresholds/thresholds.hpp"

namespace swingbank::research::blind::score {
namespace {

constexpr std::size_t kBins = std::size(kReliabilityEdges) - 1;
constexpr int kResampled = 2000;
constexpr double kBeyond95 = 0.025;  ///< probability outside a 95 % interval on either side

/// Returns the index of the bin of a probability; kBins if it is below the first edge.
std::size_t bin_of(double p) {
  if (p < kReliabilityEdges[0]) return kBins;
  std::size_t bin = 0;
  while (bin + 1 < kBins && p >= kReliabilityEdges[bin + 1]) ++bin;
  return bin;
}

struct First {
  double said;
  bool right;
};
double calibration_error(const std::vector<First>& firsts) {
  double said[kBins] = {}, right[kBins] = {};
  for (const First& f : firsts)
    if (const std::size_t bin = bin_of(f.said); bin < kBins) {
      said[bin] += f.said;
      right[bin] += f.right ? 1 : 0;
    }
  double sum = 0;
  for (std::size_t b = 0; b < kBins; ++b) sum += std::abs(said[b] - right[b]);
  return sum / static_cast<double>(firsts.size());
}

void resample(const std::vector<First>& firsts, Reliability& r) {
  std::mt19937_64 random(1);  // fixed seed for reproducible intervals
  std::uniform_int_distribution<std::size_t> any(0, firsts.size() - 1);
  std::vector<double> errors;
  for (int k = 0; k < kResampled; ++k) {
    std::vector<First> drawn;
    for (std::size_t i = 0; i < firsts.size(); ++i) drawn.push_back(firsts[any(random)]);
    errors.push_back(calibration_error(drawn));
  }
  std::ranges::sort(errors);
  r.error_low = errors[static_cast<std::size_t>(kBeyond95 * kResampled)];
  r.error_high = errors[static_cast<std::size_t>((1 - kBeyond95) * kResampled)];
}

/// Returns the number of explanations in the 95 % set: the most probable ones with a total of at least 95 %.
std::size_t set_size(const Forecast& f) {
  double sum = 0;
  std::size_t n = 0;
  while (n < f.probabilities.size() && sum < validate::thresholds::posterior.set) sum += f.probabilities[n++];
  return n;
}

std::string bar(double share) { return std::string(static_cast<std::size_t>(std::lround(20 * share)), '#'); }

}  // namespace

Reliability reliability(const std::vector<Forecast>& forecasts) {
  Reliability r;
  r.bins.resize(kBins);
  std::vector<First> firsts;
  for (const Forecast& f : forecasts) {
    if (f.probabilities.empty()) continue;
    firsts.push_back({f.probabilities.front(), f.right.front() != 0});
    for (std::size_t i = 0; i < f.probabilities.size(); ++i)
      if (const std::size_t b = bin_of(f.probabilities[i]); b < kBins) {
        r.bins[b].mean += f.probabilities[i];
        r.bins[b].right.count(f.right[i] != 0);
      }
    if (!f.listed) continue;
    auto at = std::ranges::find(r.sets, f.group, &std::pair<std::string, Reliability::Sets>::first);
    if (at == r.sets.end()) at = r.sets.insert(at, {f.group, {}});
    const std::size_t size = set_size(f);
    at->second.coverage.count(std::any_of(f.right.begin(),
                                          f.right.begin() + static_cast<std::ptrdiff_t>(size),
                                          [](char right) { return right != 0; }));
    at->second.mean_size += static_cast<double>(size);
  }
  for (auto& b : r.bins) b.mean /= std::max(1, b.right.n);
  for (auto& [name, s] : r.sets) s.mean_size /= std::max(1, s.coverage.n);
  r.cases = static_cast<int>(firsts.size());
  if (firsts.empty()) return r;
  r.error = calibration_error(firsts);
  resample(firsts, r);
  return r;
}

std::string reliability_markdown(const Reliability& r) {
  if (r.cases == 0) return "";
  std::string text =
      "\n## Reliability of the probabilities\n\nAll explanations of all cases, by stated "
      "probability (bar) and measured frequency.\n\n| stated | mean | right (n; 95 % interval) "
      "| |\n|---|---:|---|---|\n";
  for (std::size_t b = 0; b < r.bins.size(); ++b) {
    const Rate& right = r.bins[b].right;
    if (right.n == 0) continue;
    text += fmt::format("| {:.0f}–{:.0f} % | {:.0f} % | {:.0f} % ({} of {}; {:.0f}–{:.0f} %) | `{}` |\n",
                        100 * kReliabilityEdges[b], 100 * kReliabilityEdges[b + 1], 100 * r.bins[b].mean,
                        100 * right.value(), right.hits, right.n, 100 * right.low(), 100 * right.high(),
                        bar(right.value()));
  }
  text += fmt::format(
      "\nExpected calibration error of the first explanation: {:.3f} (95 % interval {:.3f}–{:.3f}, {} cases).\n\n"
      "| one listed effect hidden | in the 95 % set | mean size of the set |\n|---|---|---:|\n",
      r.error, r.error_low, r.error_high, r.cases);
  for (const auto& [group, s] : r.sets)
    text += fmt::format("| {} | {:.0f} % ({} of {}; {:.0f}–{:.0f} %) | {:.1f} |\n", group,
                        100 * s.coverage.value(), s.coverage.hits, s.coverage.n, 100 * s.coverage.low(),
                        100 * s.coverage.high(), s.mean_size);
  return text;
}

nlohmann::json reliability_json(const Reliability& r) {
  const auto rate = [](const Rate& x) {
    return nlohmann::json{
        {"hits", x.hits}, {"n", x.n}, {"rate", x.value()}, {"low", x.low()}, {"high", x.high()}};
  };
  nlohmann::json j = {{"cases", r.cases},
                      {"calibration_error", r.error},
                      {"calibration_error_low", r.error_low},
                      {"calibration_error_high", r.error_high},
                      {"bins", nlohmann::json::array()},
                      {"sets", nlohmann::json::object()}};
  for (std::size_t b = 0; b < r.bins.size(); ++b)
    j["bins"].push_back({{"from", kReliabilityEdges[b]},
                         {"to", kReliabilityEdges[b + 1]},
                         {"mean", r.bins[b].mean},
                         {"right", rate(r.bins[b].right)}});
  for (const auto& [group, s] : r.sets)
    j["sets"][group] = {{"holds_truth", rate(s.coverage)}, {"mean_size", s.mean_size}};
  return j;
}

}  // namespace swingbank::research::blind::score
