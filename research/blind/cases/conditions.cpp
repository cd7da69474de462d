// Field conditions of blind cases: reporting rates, filters, load variation, variation of the angle
// reference.
#include "research/blind/cases/detail/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace swingbank::research::blind::cases {
namespace {

constexpr double kStair = 0.025;     ///< duration of one step of the load variation [s]
constexpr double kOffset = 0.0137;   ///< start of the steps, between the samples at any rate [s]
constexpr double kMemory = 1.0;      ///< time constant of the ambient variation [s]
constexpr double kSmooth = 0.2;      ///< time constant of its smoothing; prevents detectable steps [s]
constexpr double kReactive = 0.2;    ///< ratio of the changes of Q and P, as in a load step
constexpr double kDipStart = 1.5;    ///< start of a frequency dip [s]
constexpr double kAfterDip = 5.0;    ///< duration of the record after the dip [s]
constexpr double kPerMinute = 60.0;  ///< [s]

Complex power_of(const sim::network::Load& load) { return load.power + load.current + load.admittance; }

/// Adds load steps up to `end`: `profile(k, t)` is the change of each load as a share of its power.
template <class Profile>
void move(BlindEvent& event, const sim::network::Network& network, double end, Profile profile) {
  for (const sim::network::Load& load : network.loads) {
    const double P = power_of(load).real();
    for (int k = 0; kOffset + k * kStair < end; ++k) {
      const double t = kOffset + k * kStair, part = profile(k, t);
      event.event.load_steps.push_back({load.bus, Complex(part * P, kReactive * part * P), t, t + kStair});
    }
  }
}

template <class T>
T one_of(const std::vector<T>& list, const T& otherwise, BlindDraw& draw) {
  return list.empty() ? otherwise : list[draw.below(list.size())];
}
bool happens(double share, BlindDraw& draw) { return share > 0 && draw.coin(share); }

}  // namespace

Conditions draw_conditions(const BlindConfig& config, bool instrument, bool dips, BlindDraw& draw) {
  const BlindConditions& of = config.conditions;
  Conditions c;
  const bool filtered = draw.coin(config.filter_share);
  if (filtered && !instrument) c.filter = Filter::class_p;
  c.rate = one_of(of.rates, config.rate, draw);
  c.voltage_noise = one_of(of.voltage_noise, config.voltage_noise, draw);
  if (happens(of.class_m_share, draw) && c.filter == Filter::class_p &&
      std::ranges::count(of.class_m_rates, c.rate))
    c.filter = Filter::class_m;
  if (happens(of.short_share, draw)) c.lead = of.lead;
  if (happens(of.ambient_share, draw)) c.ambient = draw.uniform(of.ambient.first, of.ambient.second);
  if (happens(of.drift_share, draw))
    c.drift = draw.uniform(of.drift.first, of.drift.second) / kPerMinute * (draw.coin() ? 1 : -1);
  if (happens(of.wander_share, draw)) {
    c.wander = draw.uniform(of.wander.first, of.wander.second);
    c.wander_s = draw.uniform(10.0, 30.0);
  }
  c.longer = happens(of.long_share, draw);
  c.switchless = happens(of.dip_share, draw) && dips;
  return c;
}

std::vector<std::string> condition_names(const Conditions& c, const BlindConfig& config) {
  std::vector<std::string> all;
  if (!config.conditions.rates.empty()) all.push_back(fmt::format("{:g}/s", c.rate));
  if (!config.conditions.voltage_noise.empty())
    all.push_back(fmt::format("noise of V {:g} times that of P", c.voltage_noise));
  if (c.filter != Filter::none) all.emplace_back(c.filter == Filter::class_m ? "class M" : "class P");
  if (std::isfinite(c.lead)) all.push_back(fmt::format("begins {:g} s before the event", c.lead));
  if (c.ambient > 0) all.emplace_back("ambient noise of the loads");
  if (c.drift != 0) all.emplace_back("loads drift");
  if (c.wander > 0) all.emplace_back("angle wanders");
  if (c.longer) all.emplace_back("one event three times as long");
  if (c.switchless) all.emplace_back("one event without switching");
  return all;
}

void let_loads_move(BlindEvent& event, const sim::network::Network& network, const Conditions& c,
                    BlindDraw& draw) {
  if (c.ambient == 0 && c.drift == 0) return;
  const double keeps = std::exp(-kStair / kMemory), smoothing = std::exp(-kStair / kSmooth);
  const double adds = c.ambient * std::sqrt((1 - keeps * keeps) * (kMemory + kSmooth) / kMemory);
  double rough = 0, noise = 0;
  move(event, network, event.seconds, [&](int k, double t) {
    if (k == 0) rough = noise = 0;  // steady state at the start of the run
    rough = keeps * rough + adds * draw.normal();
    noise = smoothing * noise + (1 - smoothing) * rough;
    return noise + c.drift * t;
  });
}

BlindEvent draw_dip(const sim::network::Network& network, BlindDraw& draw) {
  const double length = draw.uniform(20.0, 60.0), height = draw.uniform(0.02, 0.05);
  BlindEvent event;
  event.seconds = kDipStart + length + kAfterDip;
  event.text = fmt::format("from {:.1f} to {:.1f} s, all loads rise by {:.1f} % and fall back", kDipStart,
                           kDipStart + length, 100 * height);
  move(event, network, kDipStart + length, [&](int, double t) {
    return t < kDipStart ? 0.0 : height * std::pow(std::sin(constants::pi * (t - kDipStart) / length), 2);
  });
  std::erase_if(event.event.load_steps, [](const auto& step) { return step.power == Complex(0, 0); });
  return event;
}

}  // namespace swingbank::research::blind::cases
