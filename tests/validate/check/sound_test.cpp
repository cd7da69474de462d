// Sound records of many plants, events, rates and instruments pass without a finding.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/validate/playin/instrument_example.hpp"
#include "validate/check/check.hpp"

namespace swingbank::validate::check {
namespace {

std::string kinds_text(const std::vector<Finding>& findings) {
  std::string all;
  for (const auto& f : findings) all += f.kind + ": " + f.problem.sentence() + "\n";
  return all;
}

/// A grid that loses a generator: a frequency event, without voltage steps at most plants.
test::Simulated frequency_event(const std::string& name, std::size_t lost) {
  test::Simulated s{
      sim::grid::load_grid(test::source("configs/networks/" + name + ".raw"),
                           test::source("configs/networks/" + name + ".dyr"), sim::Conventions::psse()),
      3.0,
      3.0,
      {},
      {}};
  sim::network::Event event;
  event.generator_trips.push_back({s.grid.plants[lost].generator, 3.0});
  sim::reference::ReferenceOptions options;
  options.rate = 480;
  options.t_end = 10;
  options.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P, sim::Channel::Q,
                      sim::Channel::speed};
  s.before = sim::reference::run_reference(s.grid, event, options);
  return s;
}

/// Every `stride`-th sample of a record at 480/s (8 samples a cycle) after a one-cycle window over voltage
/// and current.
record::Record one_cycle(const record::Record& fine, std::size_t stride) {
  record::Record r;
  r.name = fine.name;
  r.base = fine.base;
  for (std::size_t k = 4; k + 4 < fine.t.size(); k += stride) {
    Complex v = 0, i = 0;
    for (std::size_t j = k - 4; j < k + 4; ++j) {
      const Complex u = std::polar(fine.V[j], fine.theta[j]);
      v += u / 8.0;
      i += std::conj(Complex(fine.P[j], fine.Q[j]) / u) / 8.0;
    }
    r.t.push_back(fine.t[k]);
    r.V.push_back(std::abs(v));
    r.theta.push_back(std::arg(v));
    r.P.push_back(std::real(v * std::conj(i)));
    r.Q.push_back(std::imag(v * std::conj(i)));
  }
  return r;
}

void expect_sound(const record::Record& r, double mva, const std::string& which) {
  EXPECT_EQ(kinds_text(check_record(r, {mva, 60})), "") << which;
}
/// Expects no finding for every plant in operation, at 120, 60 and 30 samples/s, noise of 0.1 and 0.2 %, with
/// and without a one-cycle window. Returns the number of records.
int expect_all_sound(const test::Simulated& s, const std::string& event, int lost = -1) {
  int records = 0;
  for (int p = 0; p < static_cast<int>(s.grid.plants.size()); ++p) {
    if (p == lost) continue;
    const double mva = s.grid.plants[static_cast<std::size_t>(p)].mva;
    for (const int stride : {4, 8, 16}) {
      const auto which =
          fmt::format("{} {} {}/s", event, s.grid.plants[static_cast<std::size_t>(p)].name, 480 / stride);
      for (const double noise : {0.0, 0.001, 0.002})
        expect_sound(test::record_of(s, p, stride, noise), mva, fmt::format("{} noise {}", which, noise)),
            ++records;
      expect_sound(one_cycle(test::record_of(s, p, 1, 0.001), static_cast<std::size_t>(stride)), mva,
                   which + " one-cycle window"),
          ++records;
    }
  }
  return records;
}

TEST(RecordSoundTest, Faults) {
  int records = 0;
  // Switching times between the samples of every rate, as in the field.
  records +=
      expect_all_sound(test::simulate("ieee14_genrou", sim::Conventions::psse(), 4, 2.0041, 2.1083), "bus 4");
  records += expect_all_sound(test::simulate("ieee14_genrou", sim::Conventions::andes(), 9, 2.0112, 2.2007),
                              "bus 9");
  records += expect_all_sound(
      test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131, 480, {0.01, 0.05}),
      "bus 16");
  records += expect_all_sound(
      test::simulate("ieee39_gencls", sim::Conventions::psse(), 26, 2.0019, 2.1, 480, {0.0, 0.05}), "bus 26");
  EXPECT_GE(records, 20);
}
TEST(RecordSoundTest, FaultsBehindAFilterLongerThanTheFault) {
  for (const auto& [bus, cleared] : {std::pair{26, 2.0541}, {26, 2.0712}, {26, 2.1083}, {16, 2.0871}}) {
    const test::Simulated s =
        test::simulate("ieee39_genrou", sim::Conventions::psse(), bus, 2.0041, cleared, 480, {0.0, 0.05});
    for (int p = 0; p < static_cast<int>(s.grid.plants.size()); ++p)
      for (const int rate : {30, 60})
        expect_sound(test::seen_through({test::instrument(fmt::format("PMUFILTER:class=1,reports={}", rate))},
                                        test::record_of(s, p, 1, 0.001), 480 / rate),
                     s.grid.plants[static_cast<std::size_t>(p)].mva,
                     fmt::format("bus {} cleared at {} s, plant {}, {}/s", bus, cleared, p, rate));
  }
}
TEST(RecordSoundTest, FrequencyEvents) {
  expect_all_sound(frequency_event("ieee39_genrou", 2), "generator lost", 2);
  expect_all_sound(frequency_event("ieee14_genrou", 1), "generator lost", 1);
}
/// A lost generator causes a small step; six samples at 30/s before it suffice to detect it.
TEST(RecordSoundTest, AcceptsEarlySmallStep) {
  constexpr std::size_t kLost = 2;
  const test::Simulated s = frequency_event("ieee39_genrou", kLost);
  for (std::size_t p = 0; p < s.grid.plants.size(); ++p) {
    if (p == kLost) continue;
    const record::Record r = record::stretch(test::record_of(s, static_cast<int>(p), 16, 0.0005), 2.8, 10.0);
    for (const Finding& f : check_record(r, {s.grid.plants[p].mva, 60}))
      EXPECT_EQ(f.severity, Severity::warn) << "plant " << p << ": " << f.problem.sentence();
  }
}
TEST(RecordSoundTest, AnotherFrameAndWrappedAngles) {
  const test::Simulated s = test::simulate("ieee14_genrou", sim::Conventions::psse(), 4, 2.0041, 2.1083);
  record::Record r = test::record_of(s, 1, 8, 0.001);
  for (std::size_t k = 0; k < r.t.size(); ++k) r.theta[k] += 1.0 + 2 * std::numbers::pi * 0.03 * r.t[k];
  r.theta_as_written = r.theta;
  for (double& a : r.theta_as_written) a = std::remainder(a, 2 * std::numbers::pi);
  expect_sound(r, r.base.mva, "0.03 Hz off nominal");
}
/// A record at 60/s from one at 480/s, the current delayed by `late` ticks.
record::Record late_current(const record::Record& fine, std::size_t late) {
  constexpr std::size_t kStride = 8;
  record::Record r;
  r.name = fine.name;
  r.base = fine.base;
  for (std::size_t k = kStride; k < fine.t.size(); k += kStride) {
    const auto phasor = [&](std::size_t n) { return std::polar(fine.V[n], fine.theta[n]); };
    const Complex i = std::conj(Complex(fine.P[k - late], fine.Q[k - late]) / phasor(k - late));
    const Complex power = phasor(k) * std::conj(i);
    r.t.push_back(fine.t[k]);
    r.V.push_back(fine.V[k]);
    r.theta.push_back(fine.theta[k]);
    r.P.push_back(power.real());
    r.Q.push_back(power.imag());
  }
  return r;
}
TEST(RecordSoundTest, NotesCurrentUpToOneSampleLate) {
  for (const double cleared : {2.1083, 2.0541}) {  // the shorter fault lasts three sample intervals
    const test::Simulated s = test::simulate("ieee14_genrou", sim::Conventions::psse(), 4, 2.0041, cleared);
    int noted = 0;
    for (const std::size_t late : {2U, 4U, 6U, 7U, 8U}) {  // of eight ticks
      const record::Record r = late_current(test::record_of(s, 1, 1, 0.0), late);
      for (const Finding& f : check_record(r, {r.base.mva, 60})) {
        EXPECT_EQ(f.kind, "time_skew") << late << " ticks: " << f.problem.sentence();
        EXPECT_EQ(f.severity, Severity::warn) << late;
        ++noted;
      }
    }
    EXPECT_GT(noted, 0) << cleared;
  }
}
TEST(RecordSoundTest, OnTheSystemBase) {
  const test::Simulated s = test::simulate("ieee39_genrou", sim::Conventions::psse(), 16, 2.0062, 2.1131);
  for (int p = 0; p < static_cast<int>(s.grid.plants.size()); ++p) {
    record::Record r = test::record_of(s, p, 8, 0.001);
    const double mva = r.base.mva;
    for (auto* c : {&r.P, &r.Q})
      for (double& x : *c) x *= mva / 100;
    r.base.mva = 100;
    expect_sound(r, mva, s.grid.plants[static_cast<std::size_t>(p)].name);
  }
}

}  // namespace
}  // namespace swingbank::validate::check
