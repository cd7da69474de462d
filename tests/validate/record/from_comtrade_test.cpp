// COMTRADE in all its formats, written here from the standard's layout (C37.111-1999 and -2013, 7 and 8).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "tests/validate/record/comtrade_writer.hpp"
#include "validate/check/check.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Form {
  int revision;
  const char* kind;
  int status;
};
class ComtradeFormTest : public ::testing::TestWithParam<Form> {};
TEST_P(ComtradeFormTest, PhasorsReadBack) {
  Writer w = phasors(GetParam().revision, GetParam().kind);
  w.status = GetParam().status;
  const Record r = w.read();
  ASSERT_EQ(r.samples(), 90);
  EXPECT_DOUBLE_EQ(r.rate(), 60);
  for (std::size_t k = 0; k < 90; ++k) {
    const double t = static_cast<double>(k) / 60;
    // Half a step of the integers, in pu and rad.
    EXPECT_NEAR(r.V[k], 1.02 + slow(t), 0.0051 / 138);
    EXPECT_NEAR(r.theta[k], (10 + 100 * slow(t)) * kPi / 180, 0.0051 * kPi / 180);
    EXPECT_NEAR(r.P[k], 0.4 + 0.5 * slow(t), 0.0051 / 200);
    EXPECT_NEAR(r.Q[k], 0.1 - 0.5 * slow(t), 0.0051 / 200);
  }
  EXPECT_EQ(r.start, "01/05/2024,12:00:00.250000");
  EXPECT_EQ(r.format, fmt::format("COMTRADE {} {}", GetParam().revision, GetParam().kind));
  EXPECT_THAT(r.ignored, ElementsAre("SPARE"));
}
INSTANTIATE_TEST_SUITE_P(
    All, ComtradeFormTest,
    ::testing::Values(Form{1991, "ASCII", 2}, Form{1991, "BINARY", 1}, Form{1999, "ASCII", 3},
                      Form{1999, "BINARY", 0}, Form{1999, "BINARY", 17}, Form{2013, "ASCII", 0},
                      Form{2013, "BINARY", 16}, Form{2013, "BINARY32", 1}, Form{2013, "FLOAT32", 2}),
    [](const auto& each) {
      return fmt::format("{}_{}_{}", each.param.revision, each.param.kind, each.param.status);
    });

TEST(RecordComtradeTest, WaveformsBecomePhasors) {
  const Record r = waveforms({}).read();
  EXPECT_DOUBLE_EQ(r.rate(), 60);
  EXPECT_EQ(r.samples(), 60);  // one for each whole cycle
  EXPECT_THAT(r.notes, Contains(HasSubstr("window of one cycle")));
  // Mean over a cycle of a movement at 0.5 Hz: at most 0.05 (2 pi 0.5/60)^2 / 24; floats add 1e-6.
  EXPECT_LT(largest_error(r, {}), 1e-5);
  EXPECT_DOUBLE_EQ(waveforms({}).read(kTestBase, {.phasor_rate = 240}).rate(), 240);
}
TEST(RecordComtradeTest, RejectsHarmonicsAndImbalance) {
  const Machine m{.harmonic = 0.05, .negative = 0.03};
  // A window of one cycle of exactly 80 samples suppresses both harmonic and negative sequence.
  EXPECT_LT(largest_error(waveforms(m).read(), m), 1e-5);
}
TEST(RecordComtradeTest, OffNominalFrequency) {
  const Machine m{.hertz_off = 0.5};
  // 1 - sinc(0.5/60) = 1.1e-4 in V, twice that in P.
  EXPECT_LT(largest_error(waveforms(m).read(), m), 3e-4);
}
TEST(RecordComtradeTest, AcceptsFractionalSamplesPerCycle) {
  // 3,000/s at 60 Hz: 50 samples a cycle; 2,500/s: 41.67, with partial weights at the window's ends, which
  // cause a ripple of the order of (2 pi/41.67)^2 / 24.
  EXPECT_LT(largest_error(waveforms({}, 3000, 3000).read(), {}), 1e-5);
  EXPECT_LT(largest_error(waveforms({}, 2500, 2500).read(), {}), 2e-3);
}
TEST(RecordComtradeTest, SecondaryValuesVoltsAndSkew) {
  Writer w = waveforms({});
  for (auto& c : w.channels) {
    const auto primary = c.value;
    const bool volt = c.unit == "kV";
    c.primary = volt ? 138000 : 1200;
    c.secondary = volt ? 115 : 5;
    c.side = 's';
    c.unit = volt ? "V" : "A";
    const double factor = volt ? 1e3 * 115 / 138000 : 5.0 / 1200;
    c.value = [=](double t) { return factor * primary(t); };
    c.skew_us = volt ? 0 : 100;
  }
  // An uncorrected skew of 100 us would be 2.2 degrees: 0.015 pu of Q.
  EXPECT_LT(largest_error(w.read(), {}), 1e-4);
}
TEST(RecordComtradeTest, PhasesInOtherSpellings) {
  Writer w = waveforms({});
  const char* const names[] = {"UL1", "IL1", "UL2", "IL2", "UL3", "IL3"};
  for (std::size_t c = 0; c < 6; ++c) w.channels[c].phase = "", w.channels[c].id = names[c];
  EXPECT_LT(largest_error(w.read(), {}), 1e-5);
}
TEST(RecordComtradeTest, SynchronisingVoltageIsNoPhase) {
  for (const char* phase : {"", "S"}) {
    Writer w = waveforms({});
    const char* const names[] = {"VA", "IA", "VB", "IB", "VC", "IC"};
    for (std::size_t c = 0; c < 6; ++c) w.channels[c].id = names[c];
    Channel other = w.channels[0];
    other.id = "VS";
    other.phase = phase;
    other.value = [](double) { return 0.0; };
    w.channels.push_back(other);
    EXPECT_LT(largest_error(w.read(), {}), 1e-5);
  }
}
TEST(RecordComtradeTest, UnitsInWords) {
  Writer w = waveforms({});
  for (auto& c : w.channels) c.unit = c.unit == "kV" ? "kVolts" : "Amps";
  EXPECT_LT(largest_error(w.read(), {}), 1e-5);
}
TEST(RecordComtradeTest, PrimaryValuesNeedNoRatio) {
  Writer w = waveforms({});
  w.edit = [](std::vector<std::string>& cfg) {
    for (std::size_t line = 2; line < 8; ++line) {
      const auto ratio = cfg[line].find(",1,1,P");
      ASSERT_NE(ratio, std::string::npos) << cfg[line];
      cfg[line].replace(ratio, 6, ",,,P");
    }
  };
  EXPECT_LT(largest_error(w.read(), {}), 1e-5);
}
TEST(RecordComtradeTest, StampsOfEarlierRevisionsAreMicroseconds) {
  Writer w = waveforms({});
  w.revision = 1999;
  w.edit = [](std::vector<std::string>& cfg) {
    for (auto& line : cfg)
      if (line.starts_with("01/05/2024")) line += "000";  // nine decimals
  };
  EXPECT_LT(largest_error(w.read(), {}), 1e-5);
}
TEST(RecordComtradeTest, OneCircuitOfSeveral) {
  Writer w = waveforms({});
  for (int p = 0; p < 3; ++p) {
    Channel other = w.channels[static_cast<std::size_t>(2 * p + 1)];
    other.component = "line 3";
    other.value = [](double) { return 0.0; };
    w.channels.push_back(other);
  }
  EXPECT_THAT(w.faults(),
              ElementsAre(AllOf(HasSubstr("several three-phase current"), HasSubstr("G7, line 3"))));
  EXPECT_LT(largest_error(w.read(kTestBase, {.terminal = "G7"}), {}), 1e-5);
}
TEST(RecordComtradeTest, TimesFromStamps) {
  Writer w = phasors(2013, "BINARY");
  w.stamps_only = true;
  EXPECT_NEAR(w.read().rate(), 60, 1e-3);  // microseconds
  w.nanoseconds = true;
  EXPECT_NEAR(w.read().rate(), 60, 1e-6);
  w = phasors();
  w.stamps_only = true;
  w.multiplier = 1000;  // stamps in milliseconds: rounded, so an even time grid is used
  const Record r = w.read();
  EXPECT_DOUBLE_EQ(r.rate(), 60);
  EXPECT_THAT(r.notes, Contains(HasSubstr("rounded to 1 ms")));
}
TEST(RecordComtradeTest, NotesContradictingStampsAndRate) {
  Writer w = phasors();
  w.edit = [](auto& lines) { lines[9] = "30,90"; };
  EXPECT_THAT(w.read().notes, Contains(HasSubstr("the rate was used")));
}

/// A recorder with a fast rate after the trigger and a slow one later: evenly spaced values keep their times.
TEST(RecordComtradeTest, SeveralRates) {
  Writer w = phasors();
  w.samples = 60 + 240 + 30;
  w.rates = {{30, 60}, {120, 300}, {30, 330}};
  const Record r = w.read();
  EXPECT_DOUBLE_EQ(r.rate(), 30);
  ASSERT_EQ(r.samples(), 60 + 60 + 30);
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    EXPECT_NEAR(r.t[k], static_cast<double>(k) / 30, 1e-9);
    EXPECT_NEAR(r.V[k], 1.02 + slow(r.t[k]), 0.0051 / 138);
  }
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("30, 120, 30 per second"), HasSubstr("decimated"))));
  w.rates = {{30, 60}, {100, 330}};
  EXPECT_THAT(w.faults(), ElementsAre(HasSubstr("100 and 30 per second")));
}
TEST(RecordComtradeTest, WaveformsOfSeveralRates) {
  Writer w = waveforms({}, 4800, 4800 + 2400);
  w.rates = {{4800, 4800}, {2400, 7200}};
  const Record two = w.read();
  EXPECT_EQ(two.samples(), 120);
  EXPECT_LT(largest_error(two, {}), 2e-5);
  // Sampling rates that follow the grid's frequency.
  w.rates = {{4800, 2000}, {4812, 4000}, {4790, 7200}};
  const Record drawn = w.read();
  EXPECT_LT(largest_error(drawn, {}), 1e-3);  // a cycle has no whole number of samples
  // RMS values of the following minute, at 60/s, are no waveforms.
  w.samples = 4800 + 60;
  w.rates = {{4800, 4800}, {60, 4860}};
  const Record fast = w.read();
  EXPECT_EQ(fast.samples(), 60);
  EXPECT_LT(largest_error(fast, {}), 1e-5);
  EXPECT_THAT(fast.notes, Contains(HasSubstr("too slow for waveforms")));
}

TEST(RecordComtradeTest, FaultsOfTheConfiguration) {
  Writer w = phasors();
  w.edit = [](auto& lines) {
    lines[8] = "2", lines[9] = "60,40", lines.insert(lines.begin() + 10, "240,30");
  };
  EXPECT_THAT(w.faults(), Contains(AllOf(HasSubstr("lasts to sample 40"), HasSubstr("e.cfg:11"))));
  w.edit = [](auto& lines) { lines[1] = "2,0A,2D"; };
  EXPECT_THAT(w.faults(),
              ElementsAre(AllOf(HasSubstr("no analogue channels"), HasSubstr("2 status channels only"))));
  w.edit = [](auto& lines) { lines[1] = "6,5A,0D"; };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("numbers of channels"), HasSubstr("e.cfg:2"))));
  w.edit = [](auto& lines) {
    lines[2] = "1,V1 MAG,,G7,kV,x,0,0,0,0,1,1,P", lines[4] = "3,P,,G7,MW,1,0", lines[12] = "GIF";
  };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("multiplier a = 'x'"), HasSubstr("e.cfg:3")),
                                      AllOf(HasSubstr("7 fields"), HasSubstr("e.cfg:5")),
                                      AllOf(HasSubstr("'GIF'"), HasSubstr("FLOAT32"))));
  w.edit = [](auto& lines) { lines.clear(); };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("end of the configuration"), HasSubstr("e.cfg:1"))));
  w.edit = [](auto& lines) { lines.resize(8); };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("end of the configuration"), HasSubstr("e.cfg:9"))));
  w.edit = [](auto& lines) { lines[2] = "1,V1 MAG,,G7,kV,1,0,0,0,0,0,0,S"; };
  EXPECT_THAT(w.faults(), ElementsAre(HasSubstr("ratio 0/0")));
}
TEST(RecordComtradeTest, FaultsOfTheData) {
  Writer w = phasors(1999, "BINARY");
  const auto read = [&](const std::string& dat) {
    return test::messages([&] { parse_comtrade(w.cfg(), dat, "e.cfg", "e.dat"); });
  };
  std::string gap = w.dat();
  gap.erase(18 * 40, 18 * 2);
  EXPECT_THAT(read(gap), ElementsAre(AllOf(HasSubstr("sample number 43"), HasSubstr("bytes 720-737"),
                                           HasSubstr("expected 41"))));
  w = phasors(1999, "ASCII");
  std::string broken = w.dat();
  broken.replace(broken.find(",", broken.find("\n40,") + 8), 2, ",x");
  EXPECT_THAT(read(broken), ElementsAre(AllOf(HasSubstr("not a number"), HasSubstr("e.dat:40"))));
}
TEST(RecordComtradeTest, MarkedSamplesAreMissing) {
  for (const auto& [revision, kind] :
       {std::pair{1999, "ASCII"}, {2013, "ASCII"}, {1999, "BINARY"}, {2013, "BINARY32"}, {2013, "FLOAT32"}}) {
    Writer w = phasors(revision, kind);
    w.missing = 50;
    EXPECT_THAT(w.faults(), ElementsAre()) << kind;
    const Record r = w.read();
    EXPECT_EQ(std::ranges::count(r.lost, 1), 1) << kind;
    EXPECT_THAT(r.notes, Contains(HasSubstr("missing ("))) << kind;
  }
  Writer w = waveforms({});
  w.missing = 50;
  EXPECT_THAT(w.faults(),
              Contains(AllOf(HasSubstr("VA"), HasSubstr("marked missing"), HasSubstr("bytes 1600-"))));
}
TEST(RecordComtradeTest, MarkedSamplesOfWaveformsCountInsideTheTimeRangeOnly) {
  Writer w = waveforms({});
  const auto faults = [&](double from, double until) -> std::string {
    try {
      (void)w.read(kTestBase, {.from = from, .until = until});
      return "";
    } catch (const InputError& e) {
      return e.what();
    }
  };
  w.missing = 960;  // 0.2 s
  EXPECT_THAT(faults(0.1, 0.9), HasSubstr("marked missing"));
  EXPECT_EQ(faults(0.3, 1.0), "");
  w.missing = 3840;  // 0.8 s
  EXPECT_THAT(faults(0.1, 0.9), HasSubstr("marked missing"));
  EXPECT_EQ(faults(0.0, 0.7), "");
}
TEST(RecordComtradeTest, ComputedPhaseHasTheSkewOfTheOthers) {
  Writer w = waveforms({});
  for (auto& c : w.channels) c.skew_us = c.unit == "kV" ? 0 : 100;
  std::erase_if(w.channels, [](const auto& c) { return c.id == "IC"; });
  EXPECT_LT(largest_error(w.read(), {}), 1e-4);  // uncorrected: 2.2 degrees of one phase, 0.005 pu of Q
  w = waveforms({});
  std::erase_if(w.channels, [](const auto& c) { return c.id == "VC"; });
  w.missing = 50;  // in VA, of which VC is computed
  EXPECT_EQ(w.faults().size(), 1u);
}
TEST(RecordComtradeTest, RefusesUnusableWaveforms) {
  Writer w = waveforms({});
  EXPECT_THAT(w.faults({200, 60, 0}), ElementsAre(HasSubstr("base_kv")));
  EXPECT_THAT(w.faults({200, 50, 138}), ElementsAre(AllOf(HasSubstr("60 Hz grid"), HasSubstr("for 50 Hz"))));
  w.channels.erase(w.channels.begin());
  EXPECT_THAT(w.faults(), ElementsAre(HasSubstr("no three-phase voltage")));
  EXPECT_THAT(waveforms({}, 240, 240).faults(), Contains(HasSubstr("at least 8 samples")));
  w = waveforms({});
  w.samples = 1;
  EXPECT_THAT(w.faults(), Contains(HasSubstr("a phasor requires the samples of one cycle")));
}

class ComtradeFileTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("comtrade-{}", ::getpid());
};
TEST_F(ComtradeFileTest, AcceptsEitherFileOfThePair) {
  const Writer w = phasors(1999, "BINARY");
  write("e.cfg", w.cfg());
  write("e.dat", w.dat());
  const Record r = read_record(folder_ / "e.cfg", kTestBase);
  EXPECT_EQ(r.samples(), 90);
  EXPECT_EQ(r.name, "e.cfg");
  EXPECT_EQ(read_record(folder_ / "e.dat", kTestBase).sha256, r.sha256);
  write("F.CFG", w.cfg());
  write("F.DAT", w.dat());
  EXPECT_EQ(read_record(folder_ / "F.CFG", kTestBase).sha256, r.sha256);
  write("alone.cfg", w.cfg());
  EXPECT_THAT(test::messages([&] { read_record(folder_ / "alone.cfg", kTestBase); }),
              ElementsAre(HasSubstr("alone.dat")));
}
TEST_F(ComtradeFileTest, OneFile) {
  for (const char* kind : {"ASCII", "BINARY", "FLOAT32"}) {
    const Writer w = phasors(2013, kind);
    const std::string dat = w.dat();
    const std::string heading =
        std::string(kind) == "ASCII" ? "ASCII" : fmt::format("{}: {}", kind, dat.size());
    write("e.cff", "--- file type: CFG ---\r\n" + w.cfg() +
                       "--- file type: INF ---\r\n\r\n--- file type: HDR ---\r\n\r\n" +
                       "--- file type: DAT " + heading + " ---\r\n" + dat);
    EXPECT_EQ(read_record(folder_ / "e.cff", kTestBase).samples(), 90) << kind;
  }
  write("e.cff", "nothing");
  EXPECT_THAT(test::messages([&] { read_record(folder_ / "e.cff", kTestBase); }),
              ElementsAre(HasSubstr("e.cff")));
}

TEST(RecordComtradeTest, AcceptsSimulatedFaultRecorderWaveforms) {
  // The waveforms of a simulated fault at a terminal, 64 samples a cycle, V and I linear between samples.
  const test::Simulated s = test::simulate("ieee14_genrou", sim::Conventions::psse(), 4, 2.0041, 2.1083);
  const Record fine = test::record_of(s, 1, 1);
  Writer w;
  w.revision = 2013;
  w.kind = "FLOAT32";
  w.rate = 3840;
  w.samples = static_cast<int>(9.9 * w.rate);
  const RecordBase base{fine.base.mva, 60, 18};
  const double volts = 18 * std::sqrt(2.0 / 3),
               amperes = fine.base.mva / (std::sqrt(3.0) * 18) * std::sqrt(2.0);
  const auto at = [&](double t, bool current) {
    const auto k = std::min(static_cast<std::size_t>(t * 480), fine.t.size() - 2);
    const double x = t * 480 - static_cast<double>(k);
    const auto phasor = [&](std::size_t j) {
      const Complex v = std::polar(fine.V[j], fine.theta[j]);
      return current ? std::conj(Complex(fine.P[j], fine.Q[j]) / v) : v;
    };
    return (1 - x) * phasor(k) + x * phasor(k + 1);
  };
  for (int p = 0; p < 3; ++p)
    for (const bool current : {false, true})
      w.channels.push_back(
          {current ? "I" : "V", std::string(1, static_cast<char>('A' + p)), "G2", current ? "kA" : "kV", 1, 0,
           [=](double t) { return Machine{}.wave(at(t, current), t, p, current ? amperes : volts); }});
  const Record r = w.read(base);
  std::string findings;
  for (const auto& f : check::check_record(r, {fine.base.mva, 60})) findings += f.problem.sentence() + "\n";
  EXPECT_EQ(findings, "");
  // Away from the switchings phasors equal the simulated values; within a cycle they move by 1e-4.
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    if (r.t[k] > 1.9 && r.t[k] < 2.3) continue;
    EXPECT_NEAR(r.V[k], std::abs(at(r.t[k], false)), 3e-4) << r.t[k];
    EXPECT_NEAR(r.P[k], std::real(at(r.t[k], false) * std::conj(at(r.t[k], true))), 1e-3) << r.t[k];
  }
}

}  // namespace
}  // namespace swingbank::validate::record
