#include "validate/hypothesis/decide.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/constants.hpp"
#include "base/in_parallel.hpp"
#include "validate/fit/sensitivities.hpp"

namespace swingbank::validate::hypothesis {
namespace {

using playin::Output;

/// Assumed noise of channels that are not recorded [pu]: 0.1 % of the base value for Efd and Ifd, and the
/// resolution of shaft pickups for speed.
constexpr double kFieldNoise = 1e-3, kSpeedNoise = 2e-5;
/// Maximum number of hypotheses that are compared.
constexpr std::size_t kCompetitors = 6;
constexpr double kFrequencyDip = 0.2;        ///< frequency drop after a remote load step [Hz]
constexpr double kFrequencyDipWithin = 1.0;  ///< duration of the frequency drop [s]
constexpr double kReferenceStep = 0.02;      ///< step of Vref [pu]
constexpr double kSceneBegins = 1.0;  ///< time from the start of the record to the load or Vref step [s]
/// Nodes and weights of Gauss-Hermite quadrature over the noise of a further record, a standard normal
/// variable.
constexpr std::array<std::pair<double, double>, 3> kNodes = {
    {{0.0, 2.0 / 3}, {std::numbers::sqrt3, 1.0 / 6}, {-std::numbers::sqrt3, 1.0 / 6}}};
constexpr std::array<std::pair<Output, const char*>, 3> kMoreChannels = {
    {{Output::Ifd, "field current"}, {Output::Efd, "field voltage"}, {Output::speed, "speed"}}};

/// A simulated experiment and its description for the user.
struct Scene {
  event::FitEvent event;
  int recorded = -1;  ///< index of the repeated event; -1: none
  std::string name;
};
/// Response of one hypothesis in a scene and its sensitivities, in units of noise.
struct ScaledResponse {
  std::array<Eigen::VectorXd, playin::kOutputs> value;
  std::array<Eigen::MatrixXd, playin::kOutputs> sensitivities;
};

/// Returns an event in which the network is undisturbed except for a frequency drop of `dip` [Hz].
event::FitEvent quiet(const event::FitEvent& like, double dip) {
  event::FitEvent e = like;
  e.switchings.clear();
  e.filtered_samples.clear();
  e.left_out.clear();
  e.clean = {};
  record::Record& r = e.record;
  double angle = std::arg(e.start.voltage);
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    r.V[k] = std::abs(e.start.voltage);
    r.theta[k] = angle;
    const double since = std::max(0.0, r.t[k] - r.t.front() - kSceneBegins);
    angle -= constants::turn * dip * std::min(1.0, since / kFrequencyDipWithin) * r.step();
  }
  return e;
}

class Separations {
 public:
  Separations(std::vector<const Judgement*> competitors, const noise::WhitenedEvents& events, double prior_sd)
      : competitors_(std::move(competitors)), events_(events), known_(competitors_.size()) {
    for (std::size_t e = 0; e < events.size(); ++e)
      scenes_.push_back({events[e], static_cast<int>(e), "in an event like " + events[e].record.name});
    scenes_.push_back({quiet(events.front(), kFrequencyDip), -1,
                       fmt::format("after a remote load step (frequency falls by {} Hz)", kFrequencyDip)});
    event::FitEvent step = quiet(events.front(), 0);
    step.record.staged = {{.kind = record::StagedEvent::Kind::vref_step,
                           .time = step.record.t.front() + kSceneBegins,
                           .size = kReferenceStep}};
    scenes_.push_back({step, -1, fmt::format("after a Vref step of {} pu", kReferenceStep)});
    for (const Judgement* j : competitors_) free_.push_back(free_of(j->hypothesis, prior_sd));
    measure_noise();
  }

  void play(int threads) {
    responses_.resize(scenes_.size() * competitors_.size());
    in_parallel(
        responses_.size(),
        [&](std::size_t k) { responses_[k] = play_one(k / competitors_.size(), k % competitors_.size()); },
        [](int) {}, threads);
    for (std::size_t j = 0; j < competitors_.size(); ++j) {
      const auto n = static_cast<Eigen::Index>(free_[j].size());
      known_[j] = Eigen::MatrixXd::Identity(n, n);
      for (std::size_t s = 0; s < events_.size(); ++s)
        if (const auto& a = response(s, j))
          for (const Output o : channels())
            known_[j] += a->sensitivities[at(o)].transpose() * a->sensitivities[at(o)];
    }
  }

  [[nodiscard]] const std::vector<Scene>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<Output>& channels() const { return events_.front().channels; }
  /// Returns chi2 of hypothesis j after its refit to the response of hypothesis i as the record. Empty if one
  /// of the two cannot be simulated.
  [[nodiscard]] std::optional<double> between(std::size_t scene, const std::vector<Output>& outputs,
                                              std::size_t i, std::size_t j) const {
    const auto &truth = response(scene, i), &other = response(scene, j);
    if (!truth || !other) return std::nullopt;
    double squares = 0;
    Eigen::MatrixXd information = known_[j];
    Eigen::VectorXd score = Eigen::VectorXd::Zero(information.rows());
    for (const Output o : outputs) {
      const Eigen::VectorXd r = other->value[at(o)] - truth->value[at(o)];
      const Eigen::MatrixXd& sensitivities = other->sensitivities[at(o)];
      squares += r.squaredNorm();
      score += sensitivities.transpose() * r;
      information += sensitivities.transpose() * sensitivities;
    }
    return std::max(0.0, squares - score.dot(information.ldlt().solve(score)));
  }

 private:
  static std::size_t at(Output o) { return static_cast<std::size_t>(o); }
  [[nodiscard]] const std::optional<ScaledResponse>& response(std::size_t scene,
                                                              std::size_t competitor) const {
    return responses_[scene * competitors_.size() + competitor];
  }
  /// Sets the noise of the recorded channels to the RMS residual of the most probable hypothesis.
  void measure_noise() {
    noise_.fill(kFieldNoise);
    noise_[at(Output::speed)] = kSpeedNoise;
    for (std::size_t c = 0; c < channels().size(); ++c) {
      double squares = 0;
      std::size_t count = 0;
      for (std::size_t e = 0; e < events_.size(); ++e) {
        const auto& measured = events_[e].measured(channels()[c]);
        const auto& model = competitors_.front()->fit.events[e].model[c];
        for (std::size_t k = 0; k < measured.size(); ++k)
          if (events_[e].compared(k)) squares += std::pow(model[k] - measured[k], 2), ++count;
      }
      noise_[at(channels()[c])] = std::sqrt(squares / static_cast<double>(count));
    }
  }
  [[nodiscard]] std::optional<ScaledResponse> play_one(std::size_t scene, std::size_t competitor) const {
    const Judgement& j = *competitors_[competitor];
    const Scene& s = scenes_[scene];
    std::vector<playin::SensitivityParameter> along;
    for (const auto& f : free_[competitor])
      along.push_back({.kind = playin::SensitivityParameter::Kind::parameter,
                       .parameter = f.id,
                       .scale = fit::axis_unit(j.fit.plant, f)});
    try {
      const playin::Response r = event::play(
          {j.fit.plant, j.hypothesis.conventions}, s.event,
          s.recorded < 0 ? event::EventState{} : j.fit.events[static_cast<std::size_t>(s.recorded)].state,
          along,
          {.sensitive = {Output::speed, Output::Efd, Output::Ifd, Output::Pm, Output::gate, Output::V}});
      ScaledResponse a;
      for (std::size_t o = 0; o < playin::kOutputs; ++o) {
        const auto column = [&](const std::vector<double>& v) -> Eigen::VectorXd {
          Eigen::VectorXd c(static_cast<Eigen::Index>(v.size()));
          for (std::size_t k = 0; k < v.size(); ++k)
            c[static_cast<Eigen::Index>(k)] = s.event.compared(k) ? v[k] / noise_[o] : 0.0;
          return c;
        };
        a.value[o] = column(r.value[o]);
        a.sensitivities[o].resize(a.value[o].size(), static_cast<Eigen::Index>(along.size()));
        for (std::size_t d = 0; d < along.size(); ++d)
          a.sensitivities[o].col(static_cast<Eigen::Index>(d)) = column(r.sensitivities[d].value[o]);
      }
      return a;
    } catch (const InputError&) {
      return std::nullopt;  // this hypothesis cannot be simulated in this scene
    }
  }

  std::vector<const Judgement*> competitors_;
  const noise::WhitenedEvents& events_;
  std::vector<Scene> scenes_;
  std::vector<std::vector<fit::FreeParameter>> free_;
  std::vector<std::optional<ScaledResponse>> responses_;  ///< [scene * competitors + competitor]
  std::vector<Eigen::MatrixXd> known_;  ///< information of priors and records on each hypothesis's parameters
  std::array<double, playin::kOutputs> noise_;
};

double effects_in_set(const std::vector<Explanation>& all) {
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(credible(all));
  return static_cast<double>(std::count_if(all.begin(), end, [](const auto& e) { return e.place >= 0; }));
}

/// Returns the expected number of effects in the credible set after this record; empty if a hypothesis cannot
/// be simulated.
std::optional<double> expected_size(const Separations& between, std::size_t scene,
                                    const std::vector<Output>& outputs, const std::vector<Explanation>& set) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < set.size(); ++i)
    for (const auto& [node, share] : kNodes) {
      std::vector<Explanation> then = set;
      for (std::size_t j = 0; j < set.size(); ++j) {
        const auto apart = i == j ? 0.0 : between.between(scene, outputs, i, j);
        if (!apart) return std::nullopt;
        then[j].evidence -= *apart + 2 * node * std::sqrt(*apart);
      }
      sum += set[i].probability * share * effects_in_set(posterior(std::move(then), -1e300));
      weight += set[i].probability * share;
    }
  return sum / weight;
}

}  // namespace

Decision what_would_decide(const std::vector<Judgement>& ranked, const std::vector<Explanation>& all,
                           const noise::WhitenedEvents& events, double prior_sd, int threads) {
  Decision d;
  d.now = effects_in_set(all);
  std::vector<Explanation> set;
  std::vector<const Judgement*> competitors;
  for (std::size_t k = 0; k < credible(all) && set.size() < kCompetitors; ++k)
    if (all[k].place >= 0) {
      set.push_back(all[k]);
      competitors.push_back(&ranked[static_cast<std::size_t>(all[k].place)]);
    }
  const bool whole = std::ranges::all_of(events, [](const event::FitEvent& e) {
    return e.record.component == record::Component::plant && e.record.staged.empty();
  });
  if (set.size() < 2 || !whole) return d;
  Separations between(competitors, events, prior_sd);
  between.play(threads);
  const auto consider = [&](std::size_t scene, const std::vector<Output>& outputs,
                            const std::string& channel) {
    const auto size = expected_size(between, scene, outputs, set);
    if (!size) return;
    const Scene& s = between.scenes()[scene];
    // Of the events that repeat a recorded one, only the best is kept for each set of channels.
    const auto like = std::ranges::find_if(d.next, [&](const NextRecord& n) {
      return s.recorded >= 0 && n.what.starts_with(channel + " in an event");
    });
    if (like == d.next.end())
      d.next.push_back({channel + " " + s.name, *size});
    else if (*size < like->expected)
      *like = {channel + " " + s.name, *size};
  };
  for (std::size_t s = 0; s < between.scenes().size(); ++s) {
    consider(s, between.channels(), "the same channels");
    for (const auto& [output, name] : kMoreChannels) {
      auto outputs = between.channels();
      if (std::ranges::count(outputs, output)) continue;
      outputs.push_back(output);
      consider(s, outputs, name);
    }
  }
  std::ranges::stable_sort(d.next, {}, &NextRecord::expected);
  return d;
}

std::string decide_sentence(const Decision& decision) {
  if (decision.next.empty()) return "";
  const NextRecord& best = decision.next.front();
  if (best.expected > decision.now - 0.5)
    return fmt::format(
        "No simulated measurement separates the candidates: after the best one ({}), {:.1f} of {:.0f} candidates "
        "remain on average.",
        best.what, best.expected, decision.now);
  if (fmt::format("{:.1f}", best.expected) == "1.0")
    return fmt::format("Next measurement: {} would identify the effect ({:.0f} candidates → 1).", best.what,
                       decision.now);
  return fmt::format("Next measurement: {} ({:.0f} candidates → {:.1f} on average).", best.what, decision.now,
                     best.expected);
}

}  // namespace swingbank::validate::hypothesis
