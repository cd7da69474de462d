// Playback through instruments: their errors are removed from the played-in signals and applied to the
// response.
#include "validate/playin/instruments.hpp"

#include <gtest/gtest.h>

#include "sim/library/library.hpp"
#include "sim/plant/measure.hpp"
#include "validate/fit/fit.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::playin {
namespace {

using Kind = SensitivityParameter::Kind;

sim::plant::Block instrument(const std::string& text) {
  Problems problems;
  const auto block = sim::plant::read_measurement(text, sim::library::compiled(), "test", problems);
  problems.raise();
  return *block;
}

class InstrumentsTest : public ::testing::Test {
 protected:
  InstrumentsTest() {
    const std::filesystem::path configs = std::filesystem::path(SWINGBANK_SOURCE) / "configs";
    model_ = plant::load_plant_model(configs / "plants" / "ieee14_bus2.toml");
    record_ = record::read_record(configs / "records" / "record-example" / "avr_ev1.csv", model_.record_base);
    switchings_ = switching::detect_switchings(record_);
  }
  PlaybackRun run_with(const sim::plant::Plant& plant, const record::Record& record,
                       const VoltageCurve& curve) const {
    PlaybackRun run{.plant = &plant, .conventions = model_.conventions, .record = &record, .curve = &curve};
    run.start = pre_event_point(record, switchings_, 1.0);
    run.tolerance = 1e-9;
    return run;
  }
  /// Returns the record's voltage and the plant's response to it, as seen through `chain`.
  record::Record seen_through(const std::vector<sim::plant::Block>& chain) const {
    const VoltageCurve curve(record_, switchings_);
    const Response plain = simulate_playback(run_with(model_.plant, record_, curve));
    record::Record seen = record_;
    sim::plant::TerminalRecord terminal{
        record_.V, record_.theta, plain.of(Output::P), plain.of(Output::Q), {}};
    auto phasors = sim::plant::phasors_of(terminal, 60.0, 60.0, "test");
    sim::plant::measure(chain, 1, phasors);
    terminal = sim::plant::terminal_of(phasors, record_.theta.front());
    seen.V = terminal.V;
    seen.theta = terminal.theta;
    seen.P = terminal.P;
    seen.Q = terminal.Q;
    return seen;
  }
  plant::PlantModel model_;
  record::Record record_;
  std::vector<Switching> switchings_;
};

TEST_F(InstrumentsTest, TransformerErrorsAreRemovedFromInputAndAppliedToOutput) {
  const std::vector<sim::plant::Block> chain = {instrument("PTERROR:gain=0.02,phase=0.03"),
                                                instrument("CTERROR:gain=-0.01,phase=-0.02")};
  record::Record seen = seen_through(chain);
  sim::plant::Plant plant = model_.plant;
  plant.measurements = chain;
  const VoltageCurve own(record_, switchings_), shown(seen, switchings_);
  PlaybackRun run = run_with(plant, seen, shown);
  // The initial P and Q as the instruments show them.
  const PlaybackRun plain = run_with(model_.plant, record_, own);
  const Complex factor = std::polar(1.02, 0.03) * std::conj(std::polar(0.99, -0.02));
  const Complex power = Complex(plain.start.P, plain.start.Q) * factor;
  run.start = plain.start;
  run.start.voltage *= std::polar(1.02, 0.03);
  run.start.P = power.real();
  run.start.Q = power.imag();
  const Response r = observe(run);
  // The integrator's tolerance of 1e-9 per step, over a few thousand steps.
  for (std::size_t k = 0; k < r.of(Output::P).size(); ++k) {
    EXPECT_NEAR(r.of(Output::P)[k], seen.P[k], 1e-6) << k;
    EXPECT_NEAR(r.of(Output::Q)[k], seen.Q[k], 1e-6) << k;
  }
}

/// An angle that was integrated from a lagged frequency is corrected; a measured angle is not changed.
TEST_F(InstrumentsTest, LagOfTheFrequencyIsRemovedFromAnIntegratedAngle) {
  constexpr double kLag = 0.1;
  const VoltageCurve own(record_, switchings_);
  const Response plain = simulate_playback(run_with(model_.plant, record_, own));
  record::Record lagged = record_;
  lagged.angle = record::AngleSource::integrated;
  double y = record_.theta.front();  // the angle lags as its frequency does; it begins at rest
  const double left = std::exp(-record_.step() / kLag), a = record_.step() / kLag;
  for (std::size_t k = 1; k < record_.theta.size(); ++k) {
    const double from = record_.theta[k - 1], to = record_.theta[k];
    y = left * y + (1 - left) * from + (to - from) * (1 - (1 - left) / a);
    lagged.theta[k] = y;
  }
  sim::plant::Plant plant = model_.plant;
  plant.measurements = {instrument("FREQLAG:lag=0.1")};
  const VoltageCurve shown(lagged, switchings_);
  const auto largest = [&](const Response& r) {
    double most = 0;
    for (std::size_t k = 0; k < r.of(Output::P).size(); ++k)
      if (std::ranges::none_of(switchings_, [&](const Switching& s) {
            return std::abs(record_.t[k] - s.time) < 4 * record_.step();  // the angle steps with the voltage
          }))
        most = std::max(most, std::abs(r.of(Output::P)[k] - plain.of(Output::P)[k]));
    return most;
  };
  const double removed = largest(observe(run_with(plant, lagged, shown))),
               left_in = largest(observe(run_with(model_.plant, lagged, shown)));
  EXPECT_LT(removed, left_in / 10) << left_in;
  const Response measured = observe(run_with(plant, record_, own));
  for (std::size_t k = 0; k < record_.t.size(); ++k)
    EXPECT_NEAR(measured.of(Output::P)[k], plain.of(Output::P)[k], 1e-12) << k;
}

TEST_F(InstrumentsTest, SkewShowsOnlyAtTheStep) {
  sim::plant::Plant plant = model_.plant;
  const VoltageCurve curve(record_, switchings_);
  const Response plain = simulate_playback(run_with(plant, record_, curve));
  plant.measurements = {instrument("SKEW:skew=0.0166")};
  const Response late = observe(run_with(plant, record_, curve));
  // The first sample of the fault follows the switching by less than the skew, so it still shows the
  // pre-fault current.
  double largest = 0;
  int moved = 0;
  for (std::size_t k = 0; k < late.of(Output::P).size(); ++k) {
    const double d = std::abs(late.of(Output::Q)[k] - plain.of(Output::Q)[k]);
    largest = std::max(largest, d);
    moved += d > 0.05;
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LE(moved, 4);
}

TEST_F(InstrumentsTest, SensitivitiesAgreeWithCentralDifferences) {
  sim::plant::Plant plant = model_.plant;
  plant.measurements = {instrument("PTERROR:gain=0.02,phase=0.03"), instrument("SKEW:skew=0.004")};
  const int first = sim::plant::first_measurement(plant);
  const std::vector<SensitivityParameter> along = {
      {.kind = Kind::parameter, .parameter = {0, 0}, .scale = 1e-4},
      {.kind = Kind::P, .scale = 1e-4},
      {.kind = Kind::parameter, .parameter = {first, 0}, .scale = 1e-4},
      {.kind = Kind::Q, .scale = 1e-4},
      {.kind = Kind::parameter, .parameter = {first, 1}, .scale = 1e-4},
      {.kind = Kind::parameter, .parameter = {first + 1, 0}, .scale = 1e-4}};
  const VoltageCurve curve(record_, switchings_);
  const PlaybackRun run = run_with(plant, record_, curve);
  const Response at = observe(run, along);
  for (std::size_t d = 0; d < along.size(); ++d) {
    const auto moved = [&](double by) {
      PlaybackRun other = run;
      sim::plant::Plant changed = plant;
      other.plant = &changed;
      const double move = by * along[d].scale;
      if (along[d].kind == Kind::parameter) sim::plant::parameter_value(changed, along[d].parameter) += move;
      if (along[d].kind == Kind::P) other.start.P += move;
      if (along[d].kind == Kind::Q) other.start.Q += move;
      return observe(other);
    };
    const Response up = moved(1), down = moved(-1);
    for (const Output o : {Output::P, Output::Q}) {
      double worst = 0, largest = 0;
      for (std::size_t k = 0; k < at.of(o).size(); ++k) {
        const double difference = (up.of(o)[k] - down.of(o)[k]) / 2;
        worst = std::max(worst, std::abs(difference - at.sensitivities[d].value[static_cast<int>(o)][k]));
        largest = std::max(largest, std::abs(difference));
      }
      // Next to a step the skewed curve has corners, and the difference quotient with a step of 2e-4 s spans
      // them.
      EXPECT_LE(worst, 2e-2 * largest + 1e-8) << "direction " << d << ", " << output_name(o);
      EXPECT_GT(largest, 0) << "direction " << d;
    }
  }
}

TEST(Instruments, RandomStepwiseAndFilterEffectsHaveNoInverse) {
  for (const char* name : {"CTERROR", "PTERROR", "SKEW"})
    EXPECT_TRUE(can_be_taken_back(*sim::library::compiled().find(name))) << name;
  for (const char* name : {"NOISE", "GAPS", "QUANTISE", "PMUFILTER"})
    EXPECT_FALSE(can_be_taken_back(*sim::library::compiled().find(name))) << name;
}

}  // namespace
}  // namespace swingbank::validate::playin
