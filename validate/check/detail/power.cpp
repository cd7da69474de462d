#include "validate/check/detail/power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace swingbank::validate::check {

bool near(double x, double target, double share) { return std::abs(x - target) <= share * std::abs(target); }

std::vector<BaseSlip> base_slips(const record::Record& r, const PlantFacts& plant) {
  const double base = r.base.mva;
  std::vector<BaseSlip> all{
      r.per_unit_power ? BaseSlip{1 / base, "P and Q are in MW and Mvar but were taken as pu",
                                  "name the columns P_MW and Q_Mvar"}
                       : BaseSlip{base, "P and Q are in pu but were taken as MW and Mvar",
                                  "name the columns P_pu and Q_pu"},
      {1e3, "P and Q are too small by a factor of 1000", "give P_MW and Q_Mvar"},
      {1e-3, "P and Q are too large by a factor of 1000, like kW taken as MW", "give P_MW and Q_Mvar"}};
  if (!r.per_unit_power) return all;  // MW and A do not depend on a base
  const std::string set = "set base_mva under [record] in the plant file to ";
  if (plant.mva > 0 && !near(plant.mva, base, 0.3))
    all.push_back(
        {plant.mva / base,
         fmt::format("P and Q are in pu on the machine's {:g} MVA, not on {:g} MVA", plant.mva, base),
         set + fmt::format("{:g}", plant.mva)});
  if (!near(base, 100, 0.3))
    all.push_back(
        {100 / base, fmt::format("P and Q are in pu on 100 MVA, not on {:g} MVA", base), set + "100"});
  return all;
}

std::optional<Doubt> base_doubt(const record::Record& r, const PlantFacts& plant, Complex power) {
  constexpr double kLargestMachinePower = 1.6,
                   kNoSlip = 100;  // pu of the machine; a wrong unit changes P and Q by a factor near 1000
  const double on_machine = std::abs(power) * (plant.mva > 0 ? r.base.mva / plant.mva : 1.0);
  if (on_machine <= kLargestMachinePower) return std::nullopt;
  if (!r.per_unit_power && plant.mva > 0 && on_machine < kNoSlip) {
    const double mw = power.real() * r.base.mva;
    const bool systems = near(plant.mva, r.base.mva, 1e-9);
    return Doubt{
        fmt::format("P = {:.4g} MW is {:.2g} times base_mva = {:g}", mw, mw / plant.mva, plant.mva),
        systems
            ? "base_mva in [plant] is probably the system's base"
            : "base_mva in [plant] is not the MVA of this machine, or the record contains another unit or several "
              "units",
        "write the machine's MVA"};
  }
  const std::string what = fmt::format(
      "apparent power of {:.4g} pu of the machine's {:g} MVA before the event", on_machine, plant.mva);
  for (const BaseSlip& slip : base_slips(r, plant))
    if (slip.factor < 1 && on_machine * slip.factor >= 0.05 && on_machine * slip.factor <= 1.2)
      return Doubt{what, "likely " + slip.why, slip.remedy};
  return Doubt{what, "the apparent power exceeds the capability of any machine",
               "check the units of P and Q, base_mva of the record and of the plant"};
}

std::optional<Doubt> dispatch_doubt(const record::Record& r, const PlantFacts& plant, Complex power) {
  if (!plant.dispatch || !(plant.mva > 0)) return std::nullopt;
  constexpr double kApartP = 0.2, kApartQ = 0.35;  // pu of the machine
  const Complex there(plant.dispatch->P, plant.dispatch->Q), here = r.base.mva * power;
  if (std::abs(here.real() - there.real()) <= kApartP * plant.mva &&
      std::abs(here.imag() - there.imag()) <= kApartQ * plant.mva)
    return std::nullopt;
  const double ratio = std::abs(here) / std::abs(there);
  const auto is_ratio = [&](double target) { return near(ratio, target, 0.05); };
  Doubt doubt{
      fmt::format("before the event P = {:.4g} MW and Q = {:.4g} Mvar, in the case {:.4g} MW and {:.4g} Mvar "
                  "(apparent power {:.2f} times the case's)",
                  here.real(), here.imag(), there.real(), there.imag(), ratio),
      "the unit ran at another operating point than in the case, or the record is of another unit or base",
      "compare bus, unit and bases with the case"};
  if (is_ratio(1)) {
    doubt.why =
        "the apparent power equals that of the case, but P and Q differ: reversed signs of P or Q, or the "
        "power-factor angle φ given as the angle of the current";
    doubt.remedy =
        "give P and Q, or the angle of the current's phasor against the same reference as the voltage's";
  } else if (is_ratio(1.0 / 3)) {
    doubt.why = "the apparent power is a third of the case's, so it is probably the power of one phase";
    doubt.remedy = "give the power of all three phases";
  } else if (is_ratio(std::numbers::sqrt3) || is_ratio(1 / std::numbers::sqrt3)) {
    doubt.why = "the factor sqrt(3) suggests that line-to-line and line-to-neutral voltage are confused";
    doubt.remedy = "check base_kv and the voltage from which P and Q were computed";
  } else if (r.per_unit_power && !near(plant.mva, r.base.mva, 0.05) &&
             (is_ratio(plant.mva / r.base.mva) || is_ratio(r.base.mva / plant.mva))) {
    doubt.why = fmt::format("that is the ratio of the bases, {:g} and {:g} MVA", plant.mva, r.base.mva);
    doubt.remedy = "check base_mva under [record] of the plant file";
  }
  return doubt;
}

std::optional<Doubt> frame_doubt(const record::Record& r, const PlantFacts& plant) {
  // pu of the machine. The voltage is twice a high temporary overvoltage. The current is twice that of a
  // bolted fault behind X" = 0.08 pu, the smallest reactance that the steps may show. At a step, V may be a
  // sample apart from P and Q, which the last value permits.
  constexpr double kImpossibleVoltage = 3, kImpossibleCurrent = 30, kPowerNoise = 0.2;
  const double per_unit = plant.mva > 0 ? r.base.mva / plant.mva : 1;
  std::size_t count = 0, first = 0;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double S = per_unit * std::hypot(r.P[k], r.Q[k]);
    if (r.V[k] <= kImpossibleVoltage && S <= kImpossibleCurrent * r.V[k] + kPowerNoise) continue;
    if (count++ == 0) first = k;
  }
  if (count == 0 || count > r.t.size() / 20) return std::nullopt;
  return Doubt{fmt::format("V = {:.4g} pu with P = {:.4g} MW and Q = {:.4g} Mvar at t = {:.4g} s{}",
                           r.V[first], r.P[first] * r.base.mva, r.Q[first] * r.base.mva, r.t[first],
                           count > 1 ? fmt::format(", and {} more frames", count - 1) : ""),
               "no plant has such a voltage or current; the frame may be damaged",
               "empty its values, or end the record before it (--until)"};
}

namespace {

/// Returns dQ/d|V| at the voltage steps [pu/pu], the smallest of three estimates: the step of Q over the same
/// interval as V, over one more sample after it, and over one more sample before it. Returns 0 unless all
/// three are positive and exceed the noise. At the terminals of a source E'' behind X'', Q = V (E''
/// cos(delta) - V) / X''. Q falls where V rises if the sum of the two values of V exceeds E'', which is below
/// 1.3 pu.
double change_of_Q(const record::Record& r, const std::vector<switching::StepInterval>& steps, double noise) {
  constexpr double kLargestE = 1.3, kSure = 5;  // [pu], [standard deviations]
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [early, late] : {std::pair<std::size_t, std::size_t>{0, 0}, {0, 1}, {1, 0}}) {
    double product = 0, square = 0;
    for (const switching::StepInterval& s : steps) {
      if (s.before < early || s.after + late >= r.V.size() || r.V[s.before] + r.V[s.after] < kLargestE)
        continue;
      const double dV = r.V[s.after] - r.V[s.before];
      product += dV * (r.Q[s.after + late] - r.Q[s.before - early]);
      square += dV * dV;
    }
    if (!(product > kSure * noise * std::sqrt(2 * square))) return 0;
    least = std::min(least, product / square);
  }
  return least;
}

}  // namespace

std::optional<Doubt> sign_doubt(const record::Record& r, const PlantFacts& plant, double P,
                                const std::vector<switching::StepInterval>& steps, double noise) {
  constexpr double kMotor = 0.05;  // pu of the machine; synchronous condensers draw a few per cent
  const double rises = change_of_Q(r, steps, noise);
  const bool with_V = rises > 0;
  const bool negative = plant.mva > 0 && P * r.base.mva < -kMotor * plant.mva &&
                        !(plant.dispatch && plant.dispatch->P < 0);  // a pump or a condenser
  const std::string mw = fmt::format("P = {:.4g} MW before the event", P * r.base.mva);
  const std::string rise =
      fmt::format("Q rises with V at its steps, by {:.4g} Mvar per pu", rises * r.base.mva);
  if (negative && with_V)
    return Doubt{mw + ", and " + rise,
                 "P and Q may be positive into the machine (load convention), or exchanged",
                 "check signs and columns; --columns P=-NAME,Q=-NAME reverses both signs"};
  if (with_V)
    return Doubt{
        rise,
        "the Q of a synchronous machine falls where V rises: its sign is reversed, or P and Q are exchanged",
        "check it; --columns Q=-NAME reverses the sign"};
  if (negative)
    return Doubt{
        mw,
        "P of a generator is positive: P uses the load convention, P and Q are exchanged, or the machine "
        "runs as a motor",
        "check it; --columns P=-NAME reverses the sign"};
  return std::nullopt;
}

}  // namespace swingbank::validate::check
