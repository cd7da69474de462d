#include "validate/check/readings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "validate/check/detail/mistakes.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/playin/voltage_curve.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::check {
namespace {

struct Hypothesis {
  const char *kind, *words, *why, *remedy;
  Reinterpret reinterpret;
  bool scales = false;  ///< the magnitude of P and Q changes
};
const std::vector<Hypothesis>& hypotheses() {
  constexpr double kPhases = 3;
  static const std::vector<Hypothesis> list = {
      {"angle_sign", "the sign of the angle reversed", "the angle may be counted positive when lagging",
       "check it; --columns theta=-NAME reverses it",
       [](const Reading& x) {
         return Reading{x.V, -x.theta, x.P, x.Q};
       }},
      {"angle_sign", "the signs of the angle and of Q reversed",
       "the phasors may be conjugated: lagging angle and absorbed Q counted as positive",
       "check them; --columns theta=-NAME,Q=-NAME reverses both",
       [](const Reading& x) {
         return Reading{x.V, -x.theta, x.P, -x.Q};
       }},
      {"q_sign", "the sign of Q reversed", "Q may be positive when the machine absorbs it",
       "check it; --columns Q=-NAME reverses it",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.P, -x.Q};
       }},
      {"power_sign", "the signs of P and Q reversed",
       "P and Q may be positive into the machine (load convention)",
       "check them; --columns P=-NAME,Q=-NAME reverses both",
       [](const Reading& x) {
         return Reading{x.V, x.theta, -x.P, -x.Q};
       }},
      {"swapped_channels", "P and Q exchanged", "their columns may be exchanged",
       "check the names of both columns",
       [](const Reading& x) {
         return Reading{x.V, x.theta, x.Q, x.P};
       }},
      {"one_phase", "P and Q three times as large", "P and Q may be those of one phase",
       "give the power of all three phases",
       [](const Reading& x) {
         return Reading{x.V, x.theta, kPhases * x.P, kPhases * x.Q};
       },
       true},
  };
  return list;
}

/// Residual share of P and Q: sum of the squared errors of the simulation over that of the squared deviations
/// from the steady state; empty: simulation failed.
using ResidualShare = std::optional<double>;

class Readings {
 public:
  Readings(const record::Record& record, const plant::PlantModel& model) : r_(record), model_(model) {}

  std::optional<Finding> run() {
    const std::optional<playin::Playback> as_is = play(r_);
    if (as_is && as_is->P.size() != r_.P.size()) return std::nullopt;
    constexpr double kFollows = 0.1;
    as_is_ = as_is ? residual_share(*as_is, r_, 0) : std::nullopt;
    if (as_is_ && *as_is_ < kFollows) return std::nullopt;
    if (as_is)
      if (auto finding = other_magnitude(*as_is)) return finding;
    if (as_is) delays(*as_is);
    const bool mirrored = r_.angle == record::AngleSource::measured;
    for (const Hypothesis& h : hypotheses()) {
      if (!mirrored && std::string_view(h.kind) == "angle_sign") continue;
      if (h.scales && !may_scale(h)) continue;
      const record::Record other = reinterpreted(h);
      if (const auto back = play(other))
        take(residual_share(*back, other, 0), {h.kind, h.words, h.why, h.remedy});
    }
    return best();
  }

 private:
  struct Words {
    std::string kind, words, why, remedy;
  };

  [[nodiscard]] std::optional<playin::Playback> play(const record::Record& record) const {
    constexpr int kStepsASample = 200;
    try {
      const auto switchings = switching::detect_switchings(record);
      return playin::play_in(model_.under_test(), record, playin::VoltageCurve(record, switchings),
                             {.tolerance = 1e-6, .step_limit = kStepsASample * record.samples()});
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  /// Compares the playback with P and Q of the record taken `delay` samples later.
  [[nodiscard]] static ResidualShare residual_share(const playin::Playback& back, const record::Record& r,
                                                    long delay) {
    double left = 0, moved = 0;
    const auto n = static_cast<long>(std::min(back.P.size(), r.P.size()));
    for (long k = std::max(0L, -delay); k < std::min(n, n - delay); ++k) {
      const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>(k + delay);
      left += std::pow(back.P[i] - r.P[j], 2) + std::pow(back.Q[i] - r.Q[j], 2);
      moved += std::pow(r.P[j] - back.start.P, 2) + std::pow(r.Q[j] - back.start.Q, 2);
    }
    if (!(moved > 0) || !std::isfinite(left)) return {};
    return left / moved;
  }

  /// Returns a warning if P or Q changes by far less or more than in the model, as with kW, MW or GW mistaken
  /// for each other. The limit is the geometric mean of a factor of 1 and one of 1000.
  [[nodiscard]] std::optional<Finding> other_magnitude(const playin::Playback& back) const {
    const double limit = std::sqrt(1000.0);
    const auto rms = [](const std::vector<double>& x, double start) {
      double sum = 0;
      for (const double v : x) sum += std::pow(v - start, 2);
      return std::sqrt(sum / static_cast<double>(x.size()));
    };
    const auto find = [&](const char* name, const char* unit, const std::vector<double>& measured,
                          const std::vector<double>& modelled, double start) -> std::optional<Finding> {
      const double is = rms(measured, start), model = rms(modelled, start), ratio = is / model;
      if (!(ratio > 0) || (ratio > 1 / limit && ratio < limit)) return std::nullopt;
      return Finding{"power_unit",
                     Severity::warn,
                     {fmt::format("a change of {} by {:.2g} {} (RMS), in the model by {:.2g} {}", name,
                                  is * r_.base.mva, unit, model * r_.base.mva, unit),
                      r_.name, fmt::format("{} may be in another unit than its column states", name),
                      fmt::format("check the unit of {}; if it is right, the model is wrong", name)}};
    };
    if (auto p = find("P", "MW", r_.P, back.P, back.start.P)) return p;
    return find("Q", "Mvar", r_.Q, back.Q, back.start.Q);
  }

  /// Tests delays of P and Q against the same simulated response.
  void delays(const playin::Playback& back) {
    constexpr double kLargestDelay = 0.5;  // s
    const auto most = static_cast<long>(std::min(kLargestDelay * r_.rate(), r_.samples() / 4.0));
    ResidualShare least;
    long at = 0;
    for (long d = -most; d <= most; ++d)
      if (const ResidualShare share = residual_share(back, r_, d); share && (!least || *share < *least))
        least = share, at = d;
    if (at == 0) return;
    const double ms = 1e3 * static_cast<double>(std::abs(at)) * r_.step();
    take(least,
         {"time_skew",
          fmt::format("P and Q {:.0f} ms {} ({} samples)", ms, at > 0 ? "earlier" : "later", std::abs(at)),
          fmt::format("they may be stamped {} than the voltage", at > 0 ? "later" : "earlier"),
          "shift their time stamps, if another clock or filter explains it"});
  }

  /// Returns whether the scaled power is feasible for the machine and, if the power-flow case is known,
  /// closer to P of the case.
  [[nodiscard]] bool may_scale(const Hypothesis& h) const {
    double p = 0, q = 0;
    constexpr std::size_t kSteadySamples = 5;
    for (std::size_t k = 0; k < kSteadySamples; ++k)
      p += r_.P[k] / kSteadySamples, q += r_.Q[k] / kSteadySamples;
    const Reading x = h.reinterpret({1, 0, p, q});
    if (std::hypot(x.P, x.Q) * r_.base.mva > 1.2 * model_.plant.mva) return false;
    if (!model_.dispatch) return true;
    const double mw = p * r_.base.mva;
    return std::abs(mw - model_.dispatch->P) > std::abs(x.P * r_.base.mva - model_.dispatch->P);
  }

  [[nodiscard]] record::Record reinterpreted(const Hypothesis& h) const {
    record::Record other = r_;
    for (std::size_t k = 0; k < r_.t.size(); ++k) {
      const Reading x = h.reinterpret({r_.V[k], r_.theta[k], r_.P[k], r_.Q[k]});
      other.theta[k] = x.theta;
      other.P[k] = x.P;
      other.Q[k] = x.Q;
    }
    other.theta_as_written.clear();
    return other;
  }

  void take(const ResidualShare& share, Words words) {
    if (!share || (best_ && *best_ <= *share)) return;
    best_ = share;
    words_ = std::move(words);
  }

  [[nodiscard]] std::optional<Finding> best() const {
    constexpr double kUnexplained = 1.0 / 16, kCloser = 3;  // share of the squared movement; ratio of rms
    if (!best_ || *best_ > kUnexplained) return std::nullopt;
    const double closer = as_is_ ? std::sqrt(*as_is_ / *best_) : std::numeric_limits<double>::infinity();
    if (closer < kCloser) return std::nullopt;
    const std::string what =
        as_is_ ? fmt::format("with {} the RMS error of P and Q is smaller by a factor of {:.0f}",
                             words_.words, closer)
               : fmt::format("playback into the model fails, but succeeds with {}", words_.words);
    return Finding{words_.kind,
                   as_is_ ? Severity::warn : Severity::refuse,
                   {what, r_.name, words_.why + "; the record was not changed", words_.remedy}};
  }

  const record::Record& r_;
  const plant::PlantModel& model_;
  ResidualShare as_is_, best_;
  Words words_;
};

}  // namespace

std::optional<Finding> better_reading(const record::Record& record, const plant::PlantModel& model) {
  if (record.component != record::Component::plant || record.angle == record::AngleSource::none ||
      !record.staged.empty() || record.P.size() != record.t.size() || record.Q.size() != record.t.size())
    return std::nullopt;
  return Readings(record, model).run();
}

}  // namespace swingbank::validate::check
