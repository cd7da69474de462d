#include "research/blind/cases/case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "research/blind/cases/detail/effects.hpp"
#include "research/blind/cases/detail/world.hpp"

namespace swingbank::research::blind::cases {
namespace {

using Scales = std::vector<std::optional<double>>;

constexpr int kAttempts = 60;    ///< maximum number of systems drawn for a case
constexpr int kEventTries = 12;  ///< maximum number of draws of one event
constexpr double kDip = 0.05;    ///< smallest voltage dip at the plant during a fault [pu]
constexpr double kLeftByAFault =
    0.02;                            ///< lowest voltage during a fault; below it the angle is undefined [pu]
constexpr double kUntripped = 0.02;  ///< largest speed deviation; above it a unit would trip [pu]
constexpr double kSizeMet = 0.1;     ///< relative tolerance of the requested size
constexpr int kSizeTries = 8;        ///< maximum number of simulations in the search for a size

constexpr double kHuge = 1e300;  ///< size of an effect that cannot be simulated

/// Returns whether hidden effects of this kind change a code of a model, which has no intermediate values.
bool turns_a_switch(const BlindKind& kind) {
  return std::ranges::any_of(kind.path, [](const BlindPath& path) {
    const sim::Effect* effect = blind_effect(path.target);
    return effect &&
           effect->parameters[static_cast<std::size_t>(effect->parameter_index(path.parameter))].is_code();
  });
}

/// Exception for a random draw that is unsuitable; another draw follows.
struct Unstable {};

class Maker {
 public:
  Maker(const BlindConfig& config, const BlindSpec& spec, BlindDraw& draw)
      : config_(config), spec_(spec), draw_(draw), world_(config, spec.hidden, draw) {
    made_.spec = spec;
    made_.noise = config.noise[draw.below(config.noise.size())];
    conditions_ = draw_conditions(config, std::ranges::any_of(spec.hidden, &BlindKind::of_instrument),
                                  world_.controlled(), draw);
    made_.pmu_filter = conditions_.filter != Filter::none;
    made_.voltage_noise = made_.noise * conditions_.voltage_noise;
    made_.conditions = condition_names(conditions_, config);
    if (!config.conditions.machines.empty())
      made_.conditions.emplace_back(target(world_.plain()).machine.effect->name);
    if (world_.transformed()) made_.conditions.emplace_back("behind its transformer");
    if (world_.recorded().size() > 1) made_.conditions.emplace_back("two units recorded together");
    made_.channels = draw.coin(config.channels_share);
    made_.controlled = world_.controlled();
    made_.grid_name = world_.grid_name();
    seed_ = draw.bits();
  }
  BlindCase make() {
    draw_events();
    choose_sizes();
    const sim::grid::Grid grid = world_.grid(scales_);
    made_.truth = target(grid);
    made_.conventions = grid.conventions;
    made_.plant_name = made_.truth.name;
    draw_model();
    if (other(grid)) made_.other = *other(grid);
    made_.records = records(grid, other(grid));
    for (validate::record::Record& record : made_.records)
      add_noise(record, {made_.noise, recorded_mva(), made_.voltage_noise, config_.speed_noise},
                made_.channels, draw_);
    return made_;
  }

 private:
  [[nodiscard]] const sim::plant::Plant& target(const sim::grid::Grid& grid) const {
    return grid.plants[static_cast<std::size_t>(world_.plant())];
  }
  /// Returns the second unit in the record; nullptr if there is none.
  [[nodiscard]] const sim::plant::Plant* other(const sim::grid::Grid& grid) const {
    if (world_.recorded().size() < 2) return nullptr;
    return &grid.plants[static_cast<std::size_t>(world_.recorded()[1])];
  }
  /// Returns the sum of the machine bases in the record [MVA].
  [[nodiscard]] double recorded_mva() const {
    const sim::plant::Plant* beside = other(world_.plain());
    return target(world_.plain()).mva + (beside ? beside->mva : 0.0);
  }
  /// Simulates one event. Throws Unstable if synchronism is lost or a speed deviation reaches kUntripped.
  [[nodiscard]] sim::reference::ReferenceRun run(const sim::grid::Grid& grid, const BlindEvent& event) const {
    sim::reference::ReferenceRun fine = simulate_fine(grid, world_.recorded(), event, config_);
    if (fine.outcome != sim::Outcome::stable) throw Unstable{};
    for (std::size_t u = 0; u < world_.recorded().size(); ++u)
      for (int k = 0; k < fine.samples; ++k)
        if (!(std::abs(fine.at(static_cast<int>(u), 4)[k]) < kUntripped)) throw Unstable{};
    return fine;
  }
  /// Returns the noise-free records of the target, or of the target and `beside` together.
  [[nodiscard]] std::vector<validate::record::Record> records(
      const sim::grid::Grid& grid, const sim::plant::Plant* beside = nullptr) const {
    std::vector<validate::record::Record> all;
    for (std::size_t e = 0; e < made_.events.size(); ++e)
      all.push_back(measured(run(grid, made_.events[e]), target(grid), made_.events[e], conditions_,
                             grid.conventions.frequency, seed_ + e, beside));
    return all;
  }
  void draw_events() {
    for (int k = 0; k < config_.faults + config_.frequency_events; ++k) made_.events.push_back(draw_event(k));
  }
  BlindEvent draw_event(int k) {
    for (int i = 0; i < kEventTries; ++i) {
      const bool fault = k < config_.faults, last = k + 1 == config_.faults + config_.frequency_events;
      const sim::network::Network& network = world_.plain().network;
      BlindEvent event = fault                            ? draw_fault(world_, draw_)
                         : last && conditions_.switchless ? draw_dip(network, draw_)
                                                          : draw_frequency_event(world_, draw_);
      if (event.seconds == 0) event.seconds = config_.seconds * (k == 0 && conditions_.longer ? 3 : 1);
      let_loads_move(event, network, conditions_, draw_);
      try {
        const sim::reference::ReferenceRun fine = run(world_.plain(), event);
        const double* v = fine.at(0, 0);
        const double least = *std::min_element(v, v + fine.samples);
        if (fault && (v[0] - least < kDip || least < kLeftByAFault)) continue;
        plain_.push_back(measured(fine, target(world_.plain()), event, conditions_,
                                  world_.plain().conventions.frequency,
                                  seed_ + static_cast<std::uint64_t>(k)));
        return event;
      } catch (const Unstable&) {  // another draw
      }
    }
    throw Unstable{};
  }
  /// Searches for the scale at which each effect has its requested size. The size grows monotonically with
  /// the scale, and almost in proportion if the path is linear.
  void choose_sizes() {
    if (spec_.hidden.empty()) return;
    const sim::grid::Grid& plain = world_.plain();
    const BlindSize size({target(plain), plain.conventions}, made_.events, plain_,
                         made_.noise * recorded_mva() / plain_.front().base.mva, made_.voltage_noise);
    scales_.assign(spec_.hidden.size(), {});
    Scales found = scales_;
    for (std::size_t k = 0; k < spec_.hidden.size(); ++k) {
      const BlindKind& kind = *spec_.hidden[k];
      BlindTruth truth;
      truth.kind = &kind;
      const double factor =
          spec_.size > 0 ? spec_.size : draw_.log_uniform(config_.size.first, config_.size.second);
      truth.wanted = factor * kind.limit;
      Scales alone = scales_;
      seek(size, k, alone, truth);
      found[k] = truth.scale;
      made_.hidden.push_back(truth);
    }
    scales_ = found;
  }
  void seek(const BlindSize& size, std::size_t k, Scales& alone, BlindTruth& truth) {
    double low = 0.0, high = 1.0, low_left = 0.0, high_left = kHuge, scale = 1.0, best = kHuge;
    // If the effect is a wrong value, its size at scale 0 is 0, which has no logarithm.
    const bool logarithmic = truth.kind->logarithmic && !truth.kind->value;
    for (int i = 0; i < kSizeTries; ++i) {
      alone[k] = scale;
      const auto [left, visible] = sizes(size, alone, *truth.kind);
      const double miss = std::abs(std::log(left / truth.wanted));
      if (left < kHuge && miss < best) {
        best = miss;
        truth.scale = scale;
        truth.left = left;
        truth.visible = visible;
      }
      const bool end = turns_a_switch(*truth.kind) || (left < truth.wanted ? scale == 1.0 : scale == 0.0);
      if (miss < std::log1p(kSizeMet) || end) break;
      (left > truth.wanted ? high : low) = scale;
      (left > truth.wanted ? high_left : low_left) = left;
      scale = next_scale(logarithmic, truth.wanted, low, low_left, high, high_left);
    }
    // Rejects the draw if no scale can be simulated, or if the effect found is too small to be detected.
    if (best == kHuge || truth.left < truth.kind->limit) throw Unstable{};
  }
  /// Returns the sizes after and before the refit at these scales. Both are kHuge if the grid is unstable.
  [[nodiscard]] std::pair<double, double> sizes(const BlindSize& size, const Scales& scales,
                                                const BlindKind& kind) const {
    try {
      const std::vector<validate::record::Record> with = records(world_.grid(scales));
      const std::span<const BlindPath> but(kind.path);
      return {size.left(with, kind.value ? but : but.first(0)), size.visible(with)};
    } catch (const Unstable&) {  // the effect is too strong: above any requested size
      return {kHuge, kHuge};
    }
  }
  static double next_scale(bool logarithmic, double wanted, double low, double low_left, double high,
                           double high_left) {
    const double middle = 0.5 * (low + high);
    if (high_left >= kHuge) return middle;
    if (logarithmic && low_left == 0.0)
      return 0.0;  // tests whether the size at scale 0 already exceeds the requested one
    double guess = high * wanted / high_left;
    if (logarithmic)
      guess = low + (high - low) * std::log(wanted / low_left) / std::log(high_left / low_left);
    return guess > low && guess < high ? guess : middle;
  }
  /// Draws the owner's model: it lacks the hidden effects, and every machine parameter is wrong, by default
  /// by 10 to 20 %.
  void draw_model() {
    made_.model = target(world_.plain());
    if (!mislead(made_.model.machine, config_.wrong, draw_)) throw Unstable{};
  }

  const BlindConfig& config_;
  const BlindSpec& spec_;
  BlindDraw& draw_;
  BlindWorld world_;
  Conditions conditions_;
  BlindCase made_;
  std::vector<validate::record::Record> plain_;  ///< without hidden effects or noise
  Scales scales_;
  std::uint64_t seed_ = 0;
};

}  // namespace

BlindCase make_blind_case(const BlindConfig& config, const BlindSpec& spec) {
  std::string last =
      "in each, the grid was unstable, the voltage dip was unsuitable, the hidden effect was too small, or no "
      "wrong model was physical";
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    BlindDraw draw(spec.seed, spec.index, static_cast<std::uint64_t>(attempt));
    try {
      BlindCase made = Maker(config, spec, draw).make();
      made.attempts = attempt + 1;
      return made;
    } catch (const Unstable&) {  // another draw
    } catch (const InputError& error) {
      last = error.what();
    }
  }
  throw InputError({fmt::format("no suitable case in {} attempts", kAttempts),
                    fmt::format("seed {}, case {}", spec.seed, spec.index), last,
                    "check the kinds of the config"});
}

}  // namespace swingbank::research::blind::cases
