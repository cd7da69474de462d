#include "validate/compare/detail/power_doubt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "validate/compare/detail/standard_deviation.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr std::size_t kRuns =
    24;  ///< largest number of playbacks for P, and for Q; adjacent samples share a playback

class PowerDoubt {
 public:
  PowerDoubt(const plant::PlantModel& model, const playin::PlayInOptions& options, EventComparison& e)
      : model_(model), options_(options), e_(e) {
    const record::Record& r = e.record;
    const double from = e.switchings.front().time - r.step(), to = e.switchings.back().time + 2 * r.step();
    first_ = static_cast<std::size_t>(std::ranges::lower_bound(r.t, from) - r.t.begin());
    last_ = static_cast<std::size_t>(std::ranges::upper_bound(r.t, to) - r.t.begin());
  }

  void run() {
    for (auto power : {&record::Record::P, &record::Record::Q}) {
      noise(power);
      beside_switchings(power);
    }
    switching_times();
  }

 private:
  /// Plays P or Q in with the pre-event noise added to the samples around the switchings.
  void noise(std::vector<double> record::Record::*power) {
    const double deviation = standard_deviation(e_.record.*power, e_.playback.start.samples);
    if (!(deviation > 0)) return;
    const std::size_t together = (last_ - first_ + kRuns - 1) / kRuns;
    for (std::size_t k = first_; k < last_; k += together) {
      const std::size_t end = std::min(k + together, last_);
      record::Record moved = e_.record;
      for (std::size_t i = k; i < end; ++i)
        (moved.*power)[i] += deviation / std::sqrt(static_cast<double>(end - k));
      play(moved, e_.switchings, 1);
    }
  }
  /// Adds the uncertainty between a switching and its adjacent samples, where P and Q are extrapolated. It is
  /// estimated from the error when an adjacent sample is itself extrapolated from the samples beyond it.
  void beside_switchings(std::vector<double> record::Record::*power) {
    constexpr double kOfStep =
        0.3;  // RMS over the switching's position, as a fraction of the error over a whole interval
    for (const switching::Switching& s : e_.switchings) {
      const auto next =
          static_cast<std::ptrdiff_t>(std::ranges::upper_bound(e_.record.t, s.time) - e_.record.t.begin());
      for (const std::ptrdiff_t side : {-1, 1}) {
        const std::ptrdiff_t at = side < 0 ? next - 1 : next;
        record::Record moved = e_.record;
        if (carry_on(moved.*power, at, side)) play(moved, e_.switchings, kOfStep);
      }
    }
  }
  /// Replaces y[at] by extrapolation, at most cubic, from the samples next to it on `side`. Returns false if
  /// there are no such samples.
  [[nodiscard]] bool carry_on(std::vector<double>& y, std::ptrdiff_t at, std::ptrdiff_t side) const {
    constexpr std::array<std::array<double, 4>, 4> kBinomial = {
        {{1, 0, 0, 0}, {2, -1, 0, 0}, {3, -3, 1, 0}, {4, -6, 4, -1}}};
    std::size_t behind = 0;
    while (behind < 4 && in_one_piece(at, at + side * static_cast<std::ptrdiff_t>(behind + 1))) ++behind;
    if (behind == 0) return false;
    double value = 0;
    for (std::size_t i = 0; i < behind; ++i)
      value += kBinomial[behind - 1][i] *
               y[static_cast<std::size_t>(at + side * static_cast<std::ptrdiff_t>(i + 1))];
    y[static_cast<std::size_t>(at)] = value;
    return true;
  }
  /// Returns whether both samples exist and no switching lies between them.
  [[nodiscard]] bool in_one_piece(std::ptrdiff_t a, std::ptrdiff_t b) const {
    const std::ptrdiff_t low = std::min(a, b), high = std::max(a, b);
    const auto& t = e_.record.t;
    if (low < 0 || high >= static_cast<std::ptrdiff_t>(t.size())) return false;
    const double from = t[static_cast<std::size_t>(low)], to = t[static_cast<std::size_t>(high)];
    return std::ranges::none_of(e_.switchings,
                                [&](const switching::Switching& s) { return from <= s.time && s.time < to; });
  }
  /// Shifts each switching time by the standard deviation of a uniform distribution over its interval.
  void switching_times() {
    for (std::size_t k = 0; k < e_.switchings.size(); ++k) {
      if (!(e_.switchings[k].uncertainty > 0)) continue;
      auto moved = e_.switchings;
      moved[k].time += moved[k].uncertainty / std::numbers::sqrt3;
      play(e_.record, moved, 1);
    }
  }
  void play(const record::Record& moved, const std::vector<switching::Switching>& switchings, double part) {
    playin::Playback other;
    try {
      other = playin::play_in_power(model_.under_test(), moved, switchings, options_);
    } catch (const InputError&) {
      return;  // no voltage yields these P and Q
    }
    const auto add = [&](const char* name, const std::vector<double>& as_is,
                         const std::vector<double>& then) {
      if (as_is.empty() || as_is.size() != then.size()) return;
      std::vector<double> shape(as_is.size());
      std::ranges::transform(then, as_is, shape.begin(),
                             [part](double a, double b) { return part * (a - b); });
      e_.doubt[name].push_back(std::move(shape));
    };
    add("V", e_.playback.V, other.V);
    add("Efd", e_.playback.Efd, other.Efd);
    add("Ifd", e_.playback.Ifd, other.Ifd);
  }

  const plant::PlantModel& model_;
  const playin::PlayInOptions& options_;
  EventComparison& e_;
  std::size_t first_, last_;
};

}  // namespace

void add_power_doubt(const plant::PlantModel& model, const playin::PlayInOptions& options,
                     EventComparison& e) {
  if (!e.switchings.empty()) PowerDoubt(model, options, e).run();
}

}  // namespace swingbank::validate::compare
