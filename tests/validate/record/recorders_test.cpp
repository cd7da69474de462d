// COMTRADE in practice: wrong configuration entries, instrument transformers between phases, several
// generators in one record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/record/comtrade_writer.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Record read(const std::string& cfg, const std::string& dat) {
  return record_of_comtrade(parse_comtrade(cfg, dat, "e.cfg", "e.dat"), "e.cfg", kTestBase, {});
}
/// Largest error of V, theta, P and Q against the values written by phasors().
double phasor_error(const Record& r) {
  double worst = r.samples() >= 60 ? 0 : 1;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double s = slow(static_cast<double>(k) / 60);
    worst = std::max({worst, std::abs(r.V[k] - 1.02 - s), std::abs(r.theta[k] - (10 + 100 * s) * kPi / 180),
                      std::abs(r.P[k] - 0.4 - 0.5 * s), std::abs(r.Q[k] - 0.1 + 0.5 * s)});
  }
  return worst;
}
constexpr double kRounding = 1e-4;  // half a step of the integers [rad]

TEST(RecorderLeniency, DateOfRevision1991HasTheMonthFirst) {
  Writer w = phasors(1991);
  w.edit = [](auto& lines) { lines[10] = "03/13/26,14:05:20.5"; };
  const Record r = w.read();
  EXPECT_LT(phasor_error(r), kRounding);
  EXPECT_EQ(r.start, "13/03/2026,14:05:20.5");
  EXPECT_THAT(r.notes, AllOf(Contains(HasSubstr("2026-03-13")), Contains(HasSubstr("taken as primary"))));
}
TEST(RecorderLeniency, MissingMultiplierIsOneAndNoted) {
  for (const int revision : {1999, 2013}) {
    Writer w = phasors(revision);
    w.stamps_only = true;
    w.edit = [](auto& lines) { lines.resize(13); };
    const Record r = w.read();
    EXPECT_NEAR(r.rate(), 60, 1e-3);
    EXPECT_LT(phasor_error(r), kRounding);
    EXPECT_THAT(r.notes, Contains(HasSubstr("time multiplier (e.cfg:13): it was taken as 1")));
  }
}
TEST(RecorderLeniency, ShortStatusLines) {
  Writer w = phasors();
  w.status = 2;
  w.edit = [](auto& lines) { lines[7] = "1,52A,,", lines[8] = "2,86G"; };
  EXPECT_LT(phasor_error(w.read()), kRounding);
}
TEST(RecorderLeniency, AsManySamplesAsAnnounced) {
  for (const char* kind : {"ASCII", "BINARY"}) {
    Writer w = phasors(1999, kind);
    w.edit = [](auto& lines) { lines[9] = "60,70"; };
    const Record r = w.read();
    EXPECT_EQ(r.samples(), 70);
    EXPECT_LT(phasor_error(r), kRounding);
    EXPECT_THAT(r.notes,
                Contains(HasSubstr("announces 70 samples, the data hold 90: the first 70 were read")));
  }
}
TEST(RecorderLeniency, LastSampleCutOff) {
  for (const char* kind : {"ASCII", "BINARY"}) {
    const Writer w = phasors(1999, kind);
    const std::string dat = w.dat();
    const Record r = read(w.cfg(), dat.substr(0, dat.size() - 7));
    EXPECT_EQ(r.samples(), 89) << kind;
    EXPECT_EQ(read(w.cfg(), dat.substr(0, dat.size() - 3)).samples(), 89) << kind << ": a digit is missing";
    EXPECT_LT(phasor_error(r), kRounding) << kind;
    EXPECT_THAT(r.notes, AllOf(Contains(HasSubstr("is truncated and was ignored")),
                               Contains(HasSubstr("announces 90 samples, the data hold 89"))));
    EXPECT_EQ(read(w.cfg(), dat + "\x1a").samples(), 90) << kind;
  }
}
TEST(RecorderLeniency, TakesDataTypeFromTheData) {
  for (const char* kind : {"ASCII", "BINARY", "BINARY32", "FLOAT32"})
    for (const char* named : {"ASCII", "BINARY", "BINARY32"}) {
      Writer w = phasors(2013, kind);
      w.edit = [&](auto& lines) { lines[12] = named; };
      const Record r = w.read();
      EXPECT_LT(phasor_error(r), kRounding) << kind << " named " << named;
      EXPECT_EQ(r.format, fmt::format("COMTRADE 2013 {}", kind));
      if (std::string(kind) != named)
        EXPECT_THAT(r.notes,
                    Contains(HasSubstr(fmt::format("data type {}, but the data are {}", named, kind))));
      else
        EXPECT_THAT(r.notes, Each(Not(HasSubstr("data type"))));
    }
}
TEST(RecorderLeniency, AcceptsOverflowingTimeStamps) {
  for (const char* kind : {"ASCII", "BINARY"}) {
    Writer w = phasors(1999, kind);
    w.stamps_only = true;
    w.first_stamp = 4294967296.0 - 500000;
    const Record r = w.read();
    EXPECT_NEAR(r.rate(), 60, 1e-3) << kind;
    EXPECT_LT(phasor_error(r), kRounding) << kind;
    EXPECT_THAT(r.notes, Contains(HasSubstr("overflow at 2^32")));
  }
}
TEST(RecorderLeniency, RefusesRateAndStampsInDifferentUnits) {
  Writer w = phasors();
  w.edit = [](auto& lines) { lines[9] = "60000,90"; };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("60000 per second, but 60 time stamps per second"),
                                            HasSubstr("in another unit"))));
}

/// Replaces the phase-to-neutral voltages of waveforms() by those between phases: ab, bc, ca.
Writer between_phases(const Machine& m, std::vector<int> pairs, bool reversed = false) {
  Writer w = waveforms(m);
  const std::vector<Channel> all = w.channels;
  w.channels.clear();
  for (const int p : pairs) {
    Channel c = all[static_cast<std::size_t>(2 * p)];
    const auto from = c.value, to = all[static_cast<std::size_t>(2 * ((p + 1) % 3))].value;
    const std::string name = std::array{"AB", "BC", "CA"}[static_cast<std::size_t>(p)];
    c.phase = reversed ? std::string(name.rbegin(), name.rend()) : name;
    c.id = "V" + c.phase;
    c.value = [=](double t) { return (reversed ? -1 : 1) * (from(t) - to(t)); };
    w.channels.push_back(c);
  }
  for (std::size_t p = 0; p < 3; ++p) w.channels.push_back(all[2 * p + 1]);
  return w;
}
TEST(RecorderWaves, VoltagesBetweenPhases) {
  for (const auto& pairs : {std::vector{0, 1, 2}, {0, 1}, {1, 2}, {0, 2}}) {
    EXPECT_LT(largest_error(between_phases({}, pairs).read(), {}), 1e-5);
    EXPECT_LT(largest_error(between_phases({}, pairs, true).read(), {}), 1e-5);
  }
  EXPECT_THAT(between_phases({}, {0, 1, 2}).read().notes, Contains(HasSubstr("divided by sqrt(3)")));
  EXPECT_THAT(between_phases({}, {0, 1}).read().notes, Contains(HasSubstr("voltage CA is not recorded")));
  EXPECT_THAT(between_phases({}, {0}).faults(),
              ElementsAre(AllOf(HasSubstr("no three-phase voltage"), HasSubstr("the voltages are VAB"))));
  Writer named = between_phases({}, {0, 1, 2});
  for (auto& c : named.channels) c.phase = "";
  EXPECT_LT(largest_error(named.read(), {}), 1e-5);
}
TEST(RecorderWaves, TwoCurrentsOfAMachine) {
  Writer w = between_phases({}, {0, 1});
  w.channels.erase(w.channels.begin() + 3);  // IB
  const Record r = w.read();
  EXPECT_LT(largest_error(r, {}), 1e-5);
  EXPECT_THAT(r.notes, Contains(HasSubstr("current of phase B is not recorded")));
}

struct Naming {
  const char *name, *form;  ///< form: quantity {0}, phase {1}, circuit {2}
  bool with_phase;
};
class RecorderNames : public ::testing::TestWithParam<Naming> {};
TEST_P(RecorderNames, IdentifyTheCircuits) {
  const Machine idle{.scale = 0.5};
  Writer w = waveforms({}), other = waveforms(idle);
  for (auto* writer : {&w, &other})
    for (auto& c : writer->channels) {
      c.id =
          fmt::format(fmt::runtime(GetParam().form), c.id.substr(0, 1), c.phase, writer == &w ? "G2" : "G1");
      c.component = "";
      if (!GetParam().with_phase) c.phase = "";
    }
  w.channels.insert(w.channels.begin(), other.channels.begin(), other.channels.end());
  Channel single = w.channels.front();
  single.id = fmt::format(fmt::runtime(GetParam().form), "V", "A", "B69");
  w.channels.push_back(single);
  EXPECT_THAT(w.faults(), Each(HasSubstr("their circuits are G1, G2")));
  EXPECT_LT(largest_error(w.read(kTestBase, {.terminal = "G2"}), {}), 1e-5);
  EXPECT_NEAR(w.read(kTestBase, {.terminal = "G1"}).V[3], 0.51, 1e-2);
  EXPECT_THAT(w.faults(kTestBase, {.terminal = "G7"}), Contains(HasSubstr("no circuit 'G7'")));
  EXPECT_THAT(w.faults(kTestBase, {.terminal = "B69"}), Contains(HasSubstr("no three-phase voltage")));
}
INSTANTIATE_TEST_SUITE_P(
    All, RecorderNames,
    ::testing::Values(Naming{"underscore", "{0}{1}_{2}", true}, Naming{"first", "{2} {0}{1}", true},
                      Naming{"dash", "{0}{1}-{2}", false}, Naming{"apart", "{2}.{0}.{1}", false},
                      Naming{"joined", "{0}{1}{2}", true}, Naming{"behind", "{2}{0}{1}", false}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(RecorderWaves, RefusesPhasorsAsWaveforms) {
  Writer w = phasors();
  w.channels.push_back({"I1 MAG", "", "G7", "A", 0.1, 0, [](double) { return 300.0; }});
  EXPECT_LT(phasor_error(w.read()), kRounding);
}
TEST(RecorderWaves, PhaseSequenceIsNamed) {
  Writer w = waveforms({});
  std::swap(w.channels[2].value, w.channels[4].value);  // VB and VC
  EXPECT_THAT(w.faults(),
              ElementsAre(AllOf(HasSubstr("phase sequence is A-C-B"), HasSubstr("of VA, VB, VC"))));
  std::swap(w.channels[3].value, w.channels[5].value);
  EXPECT_THAT(w.faults(), ElementsAre(HasSubstr("of VA, VB, VC"), HasSubstr("of IA, IB, IC")));
  w = waveforms({});
  const auto value = w.channels[3].value;
  w.channels[3].value = [=](double t) { return -value(t); };
  EXPECT_THAT(w.faults(), ElementsAre(AllOf(HasSubstr("IB has the opposite sign of IC and IA"))));
}

}  // namespace
}  // namespace swingbank::validate::record
