#include "validate/check/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/constants.hpp"
#include "validate/check/detail/findings.hpp"
#include "validate/check/detail/mistakes.hpp"
#include "validate/check/detail/power.hpp"
#include "validate/check/detail/step_fit.hpp"
#include "validate/check/signals.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::validate::check {
namespace {

bool within(double x, double low, double high) { return x >= low && x <= high; }

double square(double x) { return x * x; }

class Check : Findings {
 public:
  Check(const record::Record& record, const PlantFacts& plant)
      : Findings(record.name), r_(record), plant_(plant) {}

  std::vector<Finding> run() {
    if (!complete()) return taken();
    signals_ = record_signals(r_);
    steps_ = switching::find_large_steps(r_);
    rate();
    dropouts();
    event();
    voltage();
    frequency();
    speed();
    if (r_.angle == record::AngleSource::measured) angle();
    power();
    if (const auto doubt = frame_doubt(r_, plant_))
      refuse("impossible_frame", doubt->what, doubt->why, doubt->remedy);
    quantised();
    if (plant_.synchronous && r_.angle == record::AngleSource::measured)
      steps();  // requires measured phasors
    if (plant_.synchronous) signs();
    return taken();
  }

 private:
  /// Warns of reporting rates below 25/s, the second lowest rate for 50 Hz in IEC/IEEE 60255-118-1 (2018,
  /// 5.2).
  void rate() {
    constexpr double kSlowestRate = 24.5;
    if (r_.component != record::Component::plant || r_.rate() >= kSlowestRate) return;
    warn("slow_rate", fmt::format("{:.3g} samples/s", r_.rate()),
         fmt::format("an oscillation of 2 Hz has {:.2g} samples per period; the voltage between samples is "
                     "unknown",
                     r_.rate() / 2),
         "give a record at 25/s or more if there is one; with this record only slow quantities "
         "are reliable: inertia, governor, reactances");
  }
  static constexpr double kShortestChecked = 0.5;  ///< shortest record that the checks can interpret [s]

  /// Returns whether the record is long enough and its channels are complete and finite. Otherwise adds
  /// refusals. A record that was not read from a file may have any content.
  bool complete() {
    const std::size_t n = r_.t.size();
    if (r_.samples() < record::kMinSamples)
      refuse("too_short", fmt::format("only {} samples", n),
             fmt::format("at least {} are needed", record::kMinSamples), "give a longer record");
    else if (const double length = r_.t.back() - r_.t.front(); length < kShortestChecked)
      refuse("too_short", fmt::format("{:.3g} s is too short", length),
             "the response to an event takes seconds, and this record holds less than half a second",
             "export it from 1 s before to 5 s after the event (--from, --until)");
    for (const auto* c : {&r_.V, &r_.theta, &r_.P, &r_.Q})
      if (c->size() != n)
        refuse("incomplete", "channels of unequal length", "V, theta, P and Q need one value per sample",
               "give columns of equal length");
    for (const auto* c : {&r_.t, &r_.V, &r_.theta, &r_.P, &r_.Q, &r_.f, &r_.speed, &r_.Efd, &r_.Ifd})
      for (std::size_t k = 0; k < c->size(); ++k)
        if (!std::isfinite((*c)[k]))
          refuse("not_finite", fmt::format("sample {}", k), "a value is not finite",
                 "fill the gap at the source, or end the record before it");
    return none();
  }

  void dropouts() {
    // The reader has already interpolated frames of zeros after which V, P and Q continue as before.
    std::size_t zeros = 0, first = 0;
    for (std::size_t k = 0; k < r_.t.size(); ++k)
      if (r_.V[k] == 0 && r_.P[k] == 0 && r_.Q[k] == 0 && zeros++ == 0) first = k;
    if (zeros > 0 && zeros < r_.t.size())
      warn("dropout",
           fmt::format("{} samples with V, P and Q exactly zero, first at t = {:.4g} s", zeros, r_.t[first]),
           "they are played in as a fault at the terminals; instruments write zeros where data were lost",
           "end the record before it (--until) if there was no such fault");
    if (signals_.longest_repeat >= 3)
      warn("held_samples",
           fmt::format("{} samples in a row equal the previous one, from t = {:.4g} s",
                       signals_.longest_repeat, r_.t[signals_.repeat_start]),
           "V, its angle, P and Q are constant although the record has noise",
           "check whether data were lost and the instrument repeated its last value");
  }

  void event() {
    const double length = r_.t.back() - r_.t.front();
    if (length < 1)
      refuse("too_short", fmt::format("{:.3g} s", length),
             "a response to an event cannot be judged from less than 1 s", "give a longer record");
    else if (length < 2)
      warn("short_record", fmt::format("{:.3g} s of record", length),
           "reactances and a fast voltage regulator can be estimated, inertia roughly, governor and "
           "stabiliser not at all",
           "export at least 5 s after the event if possible");
    if (!signals_.event) {
      refuse("no_event", "no event",
             fmt::format(
                 "no signal exceeds the noise: V stays within {:.2g} pu, P within {:.2g} pu of the machine",
                 signals_.V.reach, signals_.P.reach * machine_per_record()),
             "give a record of a fault, a switching or a frequency event");
      return;
    }
    if (!beginning()) return;
    const double after = r_.t.back() - r_.t[signals_.last];
    if (after < 1)
      refuse("too_short", fmt::format("{:.3g} s after the event", after),
             "a response cannot be judged from less than 1 s", "export at least 5 s after the event");
    steadiness();
  }

  /// Returns false if the record does not contain the steady state from which the model starts.
  bool beginning() {
    constexpr double kMinBefore = 5, kLeastBefore = 0.1, kShort = 0.5;  // [samples], [s], [s]
    const double before = r_.t[signals_.onset] - r_.t.front(), n = static_cast<double>(signals_.onset + 1);
    const bool few = !signals_.slow && (n < kMinBefore || before < kLeastBefore);
    // Few samples before a step may lie within a fault, and a record without steps may begin during a swing.
    const auto looked_at = signals_.slow ? static_cast<std::size_t>(kShort * r_.rate()) + 1 : signals_.onset;
    const bool doubtful = !few && (signals_.slow || before < kShort);
    const double moves = doubtful ? moves_within(looked_at) * machine_per_record() : 0;
    const bool sagged = doubtful && !signals_.slow && std::abs(signals_.V.level - last_voltage()) > 0.08;
    if (few || sagged || moves > 0.02) {
      refuse("no_pre_event",
             few ? fmt::format("{:.3g} s before the event", before)
             : sagged
                 ? fmt::format("V = {:.3g} pu before the first step and {:.3g} pu at the end of the record",
                               signals_.V.level, last_voltage())
                 : fmt::format("P or Q moves by {:.2g} pu of the machine in the first {:.2g} s", moves,
                               static_cast<double>(looked_at) * r_.step()),
             "the model starts from the steady state before the event, which the record must contain",
             "export it from at least 1 s before the event");
      return false;
    }
    if (before < kShort)
      warn(
          "short_pre_event",
          signals_.slow ? fmt::format("a signal moves from {:.3g} s on, without a step", before)
                        : fmt::format("{:.3g} s before the event, {:.0f} samples", before, n),
          signals_.slow
              ? "the model starts at the mean of the first second (--pre-event), and playback begins "
                "with the first sample"
              : "operating point and noise are estimated from these samples only, so the noise limit is higher",
          "export it from at least 1 s before the event if possible");
    return true;
  }

  /// Returns the larger of the ranges of P and Q in the first `samples`, less the range of the noise [pu on
  /// the record's base].
  [[nodiscard]] double moves_within(std::size_t samples) const {
    double most = 0;
    for (const auto& [y, noise] : {std::pair{&r_.P, signals_.P.white}, {&r_.Q, signals_.Q.white}}) {
      const auto n = std::clamp<std::size_t>(samples, 1, y->size());
      const auto [low, high] = std::minmax_element(y->begin(), y->begin() + static_cast<std::ptrdiff_t>(n));
      most = std::max(most, *high - *low - 4 * noise);  // 4 sigma: range of the noise in half a second
    }
    return most;
  }
  /// Returns the median of V over the last second [pu].
  [[nodiscard]] double last_voltage() const {
    const auto n = std::min(r_.V.size(), static_cast<std::size_t>(r_.rate()) + 1);
    return median_of({r_.V.end() - static_cast<std::ptrdiff_t>(n), r_.V.end()});
  }

  /// Warns of quantisation by a transducer or an archive.
  void quantised() {
    const double scale = machine_per_record();
    for (const auto& [name, y, limit] :
         {std::tuple{"V", &r_.V, 2e-4}, {"P", &r_.P, 0.002 / scale}, {"Q", &r_.Q, 0.002 / scale}})
      if (const double step = record::quantum(*y); step > limit)
        warn(
            std::string("quantised_") + name,
            fmt::format("{} has a quantisation step of {:.3g} pu", name, step),
            *name == 'V'
                ? "a transducer or an archive has rounded V; a voltage regulator turns the rounding error "
                  "into a slow response, so the residual of a correct model may exceed noise"
                : "a transducer or an archive has rounded it; the noise is taken to be at least the quantisation noise",
            "export it with more digits if possible");
  }

  /// Checks that P and Q are steady before the event, because the model starts in equilibrium.
  void steadiness() {
    for (const auto& [name, s] : {std::pair{"P", &signals_.P}, {"Q", &signals_.Q}}) {
      const double scale = machine_per_record();
      const double drift = std::abs(s->drift) * scale, swing = s->swing * scale;
      const double limit = 0.005;  // pu of the machine; ambient load changes stay below it
      if (drift > std::max(limit, 6 * s->drift_error * scale))
        add("unsteady", drift > 0.05 ? Severity::refuse : Severity::warn,
            fmt::format("{} drifts by {:.2g} pu of the machine before the event", name, drift),
            "the model starts in equilibrium before the event",
            "start the record later, or take another record with less motion before the event");
      else if (swing > std::max(limit, 3 * s->white * scale))
        add("unsteady", swing > 0.05 ? Severity::refuse : Severity::warn,
            fmt::format("{} swings by {:.2g} pu of the machine (rms) before the event", name, swing),
            "the model starts in equilibrium before the event",
            "start the record later, or take another record with less motion before the event");
    }
  }

  void voltage() {
    const double v = signals_.V.level, theta = signals_.theta_level;
    // Grids are operated within 0.9 to 1.1 pu; base_kv may be a few per cent off the nominal voltage.
    if (within(v, 0.85, 1.15)) return;
    const std::string what = fmt::format("V = {:.4g} pu before the event", v);
    if (within(v, 0.7, 1.3))
      warn("unusual_voltage", what, "plants run within 0.85 to 1.15 pu",
           "check the unit of V and base_kv, the nominal voltage, line to line");
    else if (within(theta, 0.85, 1.15) || within(theta / constants::degree, 0.85, 1.15))
      refuse("swapped_channels", what + fmt::format(" and theta = {:.4g} rad", theta),
             "the angle looks like a voltage in pu", "exchange the columns of V and theta");
    else if (r_.base.kv > 0 && (near(v, r_.base.kv, 0.25) || near(v, 1e3 * r_.base.kv, 0.25)))
      refuse("voltage_unit", what,
             fmt::format("that is a voltage in kV or V ({:g} kV nominal) taken as pu", r_.base.kv),
             "name the column V_kV");
    else if (near(v, std::numbers::sqrt3, 0.12) || near(v, 1 / std::numbers::sqrt3, 0.12))
      refuse("voltage_unit", what, "V differs from 1 pu by a factor of sqrt(3)",
             v < 1 ? "if V is line to neutral, name the column V_kV_ln; base_kv is always line to line"
                   : "give base_kv line to line, or name the column V_kV if V is line to line");
    else if (r_.base.kv > 1 && near(v, 1e3, 0.25))  // a case without nominal voltages has base_kv = 1
      refuse("voltage_unit", fmt::format("{}, with base_kv = {:g} kV", what, r_.base.kv),
             "that is a voltage in V taken as kV", "name the column V_V");
    else if (within(v, 70, 130))
      refuse("voltage_unit", what, "that may be a voltage in percent, or in kV, taken as pu",
             "name the column V_kV and give base_kv, or divide by 100");
    else if (v > 1.3 && r_.base.kv > 0)
      refuse("voltage_unit", fmt::format("{}, with base_kv = {:g} kV", what, r_.base.kv),
             "base_kv is not the nominal voltage of that bus, or a voltage in kV was taken as pu",
             fmt::format("set base_kv under [record] in the plant file to the nominal voltage in kV, line to "
                         "line (near {:.3g} if the column is in kV), or name the column V_kV",
                         v * r_.base.kv));
    else if (v > 1.3)
      refuse("voltage_unit", what, "that may be a voltage in kV taken as pu",
             "name the column V_kV and give base_kv under [record] in the plant file");
    else
      refuse("voltage_unit", what, "V of a plant is near 1 pu",
             "check the column of V, its unit and base_kv");
  }

  /// Returns whether the frequency `ratio` [pu of the model's nominal frequency] is the other nominal
  /// frequency, 50 or 60 Hz.
  [[nodiscard]] bool other_nominal(double ratio) const {
    return near(ratio, other_hz() / plant_.frequency, 0.02);
  }
  [[nodiscard]] double other_hz() const { return std::abs(plant_.frequency - 60) < 5 ? 50 : 60; }

  void frequency() {
    if (!r_.f.empty()) {
      const double ratio = 1 + median_of(r_.f), hz = ratio * r_.base.frequency;
      const std::string what = fmt::format("a frequency of {:.4g} Hz", hz);
      if (other_nominal(ratio))
        refuse("nominal_frequency", what, fmt::format("the model is for {:g} Hz", plant_.frequency),
               fmt::format("set frequency_hz = {:g} in the plant file, or take that plant's own record",
                           other_hz()));
      else if (std::abs(ratio) < 0.03)
        refuse("frequency_unit", what, "f looks like a deviation, or per unit taken as Hz",
               "give f_pu with 1 at nominal frequency, or f_hz");
      else if (within(ratio, 40, 70))
        refuse("frequency_unit", what, "f is in Hz but was taken as pu", "name the column f_hz");
      else if (!within(ratio, 0.93, 1.07))
        refuse("frequency_unit", what, "a plant runs near nominal frequency",
               "check the column of f and its unit");
    }
    const double hz = signals_.angle_rate / constants::turn;
    if (std::abs(hz) < 2) return;
    const bool ten = near(std::abs(hz), 10, 0.1);
    refuse(ten ? "nominal_frequency" : "angle_frame",
           fmt::format("the angle rotates at {:.3g} Hz before the event", hz),
           ten ? fmt::format(
                     "the record is of a {:g} Hz grid, or its angle is not relative to the model's {:g} Hz",
                     other_hz(), plant_.frequency)
               : std::string("it is not in the frame of nominal frequency, or its unit is wrong"),
           ten ? fmt::format("set frequency_hz = {:g} in the plant file, or take that plant's own record",
                             other_hz())
               : std::string(
                     "give the angle of the phasor against nominal frequency, in rad or degrees as named"));
  }

  void speed() {
    if (r_.speed.empty()) return;
    const double s = median_of(r_.speed);
    if (std::abs(s) < 0.07) return;
    const std::string what = fmt::format("a speed deviation of {:.4g} pu", s);
    if (near(s, 1, 0.05))
      refuse("speed_unit", what, "the column contains the speed, not its deviation",
             "name the column omega_pu");
    else if (near(s, -1, 0.05))
      refuse("speed_unit", what, "the column holds deviations", "name the column speed_pu");
    else if (other_nominal(1 + s))
      refuse("nominal_frequency", what, fmt::format("the model is for {:g} Hz", plant_.frequency),
             "take that plant's own record");
    else
      refuse("speed_unit", what, "a machine runs near nominal speed", "give the speed in pu");
  }

  /// Returns whether an angle beyond a full turn is in unwrapped radians, as simulation programs write it.
  /// Its rate must match the recorded frequency. If the frequency is not conclusive, the steps must match a
  /// machine better in radians than in degrees.
  [[nodiscard]] bool radians_beyond_a_turn() const {
    if (const double ratio = signals_.angle_per_frequency; ratio > 0) return within(ratio, 0.5, 2);
    const int delay = power_delay(r_, steps_);
    const StepFit radians = fit_steps(r_, steps_, delay);
    const record::Record other = reinterpreted(r_, [](const Reading& x) {
      return Reading{x.V, x.theta * constants::degree, x.P, x.Q};
    });
    // An angle that hardly steps fits in either unit and is not conclusive.
    return fits(radians) && 3 * radians.residual < fit_steps(other, steps_, delay).residual;
  }
  /// Returns whether the fit is that of a sound record: residual below 0.03 plus noise
  /// (tests/validate/check/sound_test.cpp).
  [[nodiscard]] bool fits(const StepFit& fit) const {
    const double noise = noise_share(fit);
    return fit.reactance > 0 && noise < 0.1 && fit.residual < 0.03 + 3 * noise;
  }

  void angle() {
    const char* const name_deg = "name the column theta_deg";
    if (signals_.wraps_of_360)
      refuse("angle_unit", fmt::format("an angle of {:.4g} rad", signals_.first_angle),
             "it steps by 360 where it is wrapped: these are degrees taken as radians", name_deg);
    else if (std::abs(signals_.first_angle) > 2.1 * constants::pi && !radians_beyond_a_turn())
      refuse(
          "angle_unit", fmt::format("an angle of {:.4g} rad", signals_.first_angle),
          "that exceeds a full turn, and neither the frequency nor the steps confirm unwrapped radians",
          "name the column theta_deg if it is in degrees; otherwise subtract multiples of 2π, or add the column "
          "of the frequency");
    // A frequency or speed in a wrong unit cannot be compared with the angle.
    const double ratio = found("frequency_unit") || found("speed_unit") ? 0 : signals_.angle_per_frequency;
    if (within(ratio, 18, 180))
      refuse("angle_unit",
             fmt::format("an angle that rotates {:.0f} times as fast as the recorded frequency", ratio),
             "degrees were taken as radians", name_deg);
    else if (ratio > 0 && within(1 / ratio, 18, 180))
      refuse("angle_unit",
             fmt::format("an angle that rotates {:.0f} times slower than the recorded frequency", 1 / ratio),
             "radians were taken as degrees", "name the column theta_rad");
    else if (signals_.fast_angle > constants::turn * 4)
      refuse("angle_unit", fmt::format("an angle that rotates at {:.3g} rad/s", signals_.fast_angle),
             "the angle of a machine changes more slowly; degrees were probably taken as radians", name_deg);
  }

  [[nodiscard]] double machine_per_record() const { return plant_.mva > 0 ? r_.base.mva / plant_.mva : 1.0; }

  void power() {
    if (const auto doubt = base_doubt(r_, plant_, {signals_.P.level, signals_.Q.level}))
      refuse("wrong_base", doubt->what, doubt->why, doubt->remedy);
    else if (const auto apart = dispatch_doubt(r_, plant_, {signals_.P.level, signals_.Q.level}))
      warn("dispatch", apart->what, apart->why, apart->remedy);
    else if (const double share = std::hypot(signals_.P.level, signals_.Q.level) * machine_per_record();
             plant_.mva > 0 && share < 0.01)
      warn("small_power",
           fmt::format(
               "P = {:.3g} MW and Q = {:.3g} Mvar before the event, {:.2g} % of the machine's {:g} MVA",
               signals_.P.level * r_.base.mva, signals_.Q.level * r_.base.mva, 100 * share, plant_.mva),
           "the unit idled, or the headings name wrong units of P and Q",
           "check their units, and base_mva of the record and of the plant");
  }

  /// Warns of doubtful signs of P and Q, unless the steps of the phasors have already given a finding.
  void signs() {
    if (found("swapped_channels") || found("q_sign") || found("power_sign")) return;
    if (const auto doubt = sign_doubt(r_, plant_, signals_.P.level, steps_, signals_.Q.white))
      warn(signals_.P.level < 0 ? "power_sign" : "q_sign", doubt->what, doubt->why, doubt->remedy);
  }

  void steps() {
    if (found("voltage_unit") || found("angle_unit") || found("angle_frame")) return;
    const int delay = power_delay(r_, steps_);
    if (delay != 0)
      warn("time_skew",
           fmt::format("P and Q step {:.0f} ms {} the voltage", 1e3 * std::abs(delay) * r_.step(),
                       delay > 0 ? "after" : "before"),
           "V and P, Q have different clocks or filter delays", "shift them so that their steps coincide");
    const StepFit as_is = fit_steps(r_, steps_, delay);
    std::vector<Explanation> explanations;
    for (const auto& m : mistakes()) {
      const record::Record alternative = reinterpreted(r_, m.reinterpret);
      const std::vector<switching::StepInterval> there = switching::find_large_steps(alternative);
      const StepFit fit = fit_steps(alternative, there, delay), same = fit_steps(r_, there, delay);
      const double noise = noise_share(fit);
      if (!(fit.reactance > 0 && noise < 0.1 && fit.residual < 0.01 + 2 * noise)) continue;
      if (m.turn > 0 &&
          std::ranges::none_of(there, [&](const switching::StepInterval& j) { return turned(j) > m.turn; }))
        continue;
      // The residual of sound records is below m.sound plus noise (tests/validate/check/sound_test.cpp).
      const bool sound =
          same.reactance > 0 && (same.residual < m.sound + 2 * noise || same.residual < 5 * fit.residual);
      if (!sound) explanations.push_back({&m, fit.residual});
    }
    const Explanation* best = likeliest(explanations);
    if (best && apart())
      warn("time_skew", "steps of V and of the current up to one sample apart",
           "one of the channels is delayed",
           "correct its time stamps, or let `swingbank diagnose` fit the skew (SKEW)");
    else if (best)
      add(inconsistent_steps(r_.name, *best, explanations));
    else if (fits(as_is))
      reactance(as_is.reactance * plant_.mva / r_.base.mva);
  }

  /// Returns whether the steps are consistent if each is extended by one sample interval before it, after it,
  /// or on both sides. Voltage and current then step at different samples.
  [[nodiscard]] bool apart() const {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> kWider = {{{1, 1}, {0, 1}, {1, 0}}};
    return std::ranges::any_of(kWider, [this](const auto& wider) {
      std::vector<switching::StepInterval> wide;
      for (const switching::StepInterval& j : steps_)
        if (j.before >= wider.first) wide.push_back({j.before - wider.first, j.after + wider.second});
      const StepFit fit = fit_steps(r_, wide, 0);
      const double noise = noise_share(fit);
      return fit.reactance > 0 && noise < 0.1 && fit.residual < 0.03 + 2 * noise;
    });
  }
  /// Returns the step of the angle as written in the record [rad].
  [[nodiscard]] double turned(const switching::StepInterval& j) const {
    const std::vector<double>& theta = r_.written_angle();
    return std::abs(theta[j.after] - theta[j.before]);
  }

  /// Returns the share of noise in the squared steps [-]. A step combines four samples (fit_steps), so its
  /// variance is five times that of one sample.
  [[nodiscard]] double noise_share(const StepFit& fit) const {
    return 10 * square(signals_.V.white) / fit.voltage +
           5 * (square(signals_.P.white) + square(signals_.Q.white)) / fit.current;
  }

  /// Checks X'' [pu of the machine]: 0.1 to 0.4 pu in machines, up to 0.6 pu with a step-up transformer.
  void reactance(double x) {
    if (!(plant_.mva > 0) || within(x, 0.08, 0.8)) return;
    const BaseSlip* best = nullptr;
    const std::vector<BaseSlip> all = base_slips(r_, plant_);
    const auto distance = [](double z) { return std::abs(std::log(z / 0.25)); };
    for (const auto& b : all)  // multiplying P by the factor divides X by it
      if (distance(x / b.factor) < (best ? distance(x / best->factor) : std::log(2.5))) best = &b;
    const std::string what =
        fmt::format("steps of P and Q that correspond to a reactance of {:.3g} pu of the machine", x);
    if (best && !within(x, 0.06, 1.0))
      refuse("wrong_base", what, "likely " + best->why, best->remedy);
    else
      warn("wrong_base", what, "X\"d of machines is 0.1 to 0.4 pu",
           "check base_mva of the record and of the plant");
  }

  const record::Record& r_;
  PlantFacts plant_;
  Signals signals_;
  std::vector<switching::StepInterval> steps_;
};

}  // namespace

PlantFacts plant_facts(const plant::PlantModel& model) {
  return {model.plant.mva, model.record_base.frequency, !model.plant.machine.effect->converter,
          model.dispatch};
}

std::vector<Finding> check_record(const record::Record& record, const PlantFacts& plant) {
  return Check(record, plant).run();
}

void raise_refusals(const std::vector<Finding>& findings) {
  Problems problems;
  for (const auto& f : findings)
    if (f.severity == Severity::refuse)
      problems.add(f.problem.what, f.problem.where, f.problem.why, f.problem.remedy);
  problems.raise();
}

}  // namespace swingbank::validate::check
