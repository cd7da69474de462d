// A whole grid against records of its terminals, simulated with the same grid, unchanged or modified.
#include "validate/system/system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <numbers>
#include <random>

#include "base/json.hpp"
#include "sim/grid/attach.hpp"
#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::system {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;

/// A temporary folder with a system file and records for each test.
class SystemCompare : public ::testing::Test {
 protected:
  SystemCompare() {
    std::string name = (fs::temp_directory_path() / "swingbank-system-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~SystemCompare() override { fs::remove_all(folder); }

  struct Truth {
    std::vector<std::string> attached;
    double t_on = 2, t_off = 2.1, noise = 2e-4, shift_V = 0;
    int window = 0;       ///< samples to either side in a triangular filter
    int fine = 8;         ///< samples of the simulation per sample of the record
    bool meters = false;  ///< a meter's frequency [Hz] in place of the angle
  };
  /// Returns every `fine`-th phasor, filtered.
  static std::vector<Complex> seen(const std::vector<Complex>& fine, const Truth& truth) {
    std::vector<Complex> values;
    const int last = static_cast<int>(fine.size()) - 1;
    for (int k = 0; k <= last; k += truth.fine) {
      Complex sum = 0;
      double weights = 0;
      for (int j = -truth.window; j <= truth.window; ++j) {
        const double weight = 1 - std::abs(j) / (truth.window + 1.0);
        sum += weight * fine[static_cast<std::size_t>(std::clamp(k + j, 0, last))];
        weights += weight;
      }
      values.push_back(sum / weights);
    }
    return values;
  }
  static std::vector<double> unwrapped(const std::vector<Complex>& V) {
    std::vector<double> angle = {std::arg(V.front())};
    for (std::size_t k = 1; k < V.size(); ++k)
      angle.push_back(angle.back() + std::remainder(std::arg(V[k]) - angle.back(), 2 * std::numbers::pi));
    return angle;
  }
  /// Returns a meter's frequency from an angle [rad] at 60/s: the mean over two intervals, with noise of 1
  /// mHz.
  static std::vector<double> metered(const std::vector<double>& angle, std::mt19937& random) {
    std::normal_distribution<double> noise(0, 1e-3);
    std::vector<double> f;
    for (std::size_t k = 0; k < angle.size(); ++k) {
      const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, angle.size() - 1);
      f.push_back(60 + 60 * (angle[b] - angle[a]) / static_cast<double>(b - a) / (2 * std::numbers::pi) +
                  noise(random));
    }
    return f;
  }
  /// Writes records of plants 1, 2, 8 and bus 5 of IEEE 14 with governors and exciters, fault at bus 4; white
  /// noise [pu].
  void record(const Truth& truth) const {
    sim::grid::Grid grid =
        sim::grid::load_grid(test::source("configs/networks/ieee14_genrou.raw"),
                             test::source("configs/networks/ieee14_genrou.dyr"), sim::Conventions::psse());
    Problems problems;
    for (const auto& text : truth.attached) sim::grid::attach(grid, text, text, problems);
    problems.raise();
    sim::network::Event event;
    event.faults.push_back({grid.network.bus_index(4), truth.t_on, truth.t_off});
    sim::reference::ReferenceOptions o;
    o.t_end = 10;
    o.rate = 60 * truth.fine;
    o.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P, sim::Channel::Q};
    o.buses = {grid.network.bus_index(5)};
    const sim::reference::ReferenceRun run = sim::reference::run_reference(grid, event, o);
    ASSERT_EQ(run.outcome, sim::Outcome::stable);
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, truth.noise);
    for (std::size_t p = 0; p < run.plants.size(); ++p) {
      const sim::plant::Plant& plant = grid.plants[static_cast<std::size_t>(run.plants[p])];
      std::ofstream out(folder / ("plant" + plant.name + ".csv"));
      out.precision(10);
      out << "t_s,V_pu," << (truth.meters ? "f_Hz" : "theta_rad") << ",P_pu,Q_pu\n";
      std::vector<Complex> V, I;
      for (int k = 0; k < run.samples; ++k) {
        const auto at = [&](int c) { return run.at(static_cast<int>(p), c)[k]; };
        V.push_back(std::polar(at(0), at(1)));
        I.push_back(std::conj(Complex(at(2), at(3)) * (plant.mva / 100) / V.back()));
      }
      V = seen(V, truth);
      I = seen(I, truth);
      const auto angle = unwrapped(V);
      const auto frequency = metered(angle, random);
      for (std::size_t k = 0; k < V.size(); ++k) {
        const Complex power = V[k] * std::conj(I[k]);
        out << static_cast<double>(k) / 60.0 << ',' << std::abs(V[k]) + truth.shift_V + noise(random) << ','
            << (truth.meters ? frequency[k] : angle[k] + noise(random)) << ',' << power.real() + noise(random)
            << ',' << power.imag() + noise(random) << '\n';
      }
    }
    std::ofstream out(folder / "bus5.csv");
    out.precision(10);
    out << "t_s,V_pu," << (truth.meters ? "f_Hz\n" : "theta_rad\n");
    std::vector<Complex> V;
    for (std::size_t k = 0; k < static_cast<std::size_t>(run.samples); ++k)
      V.push_back(std::polar(run.bus_v[k], run.bus_theta[k]));
    V = seen(V, truth);
    const auto angle = unwrapped(V);
    const auto frequency = metered(angle, random);
    for (std::size_t k = 0; k < V.size(); ++k) {
      out << static_cast<double>(k) / 60.0 << ',' << std::abs(V[k]) + noise(random) << ','
          << (truth.meters ? frequency[k] : angle[k] + noise(random)) << '\n';
    }
  }
  /// Writes the system file with `from` replaced by `to`.
  fs::path system(const std::string& from = "", const std::string& to = "") const {
    std::string text = R"(
[system]
name = "IEEE 14"
raw = "RAW"
dyr = "DYR"
conventions = "psse"
attach = ["all:TGOV1:R=0.05,T1=0.5", "all:SEXS"]
[event]
fault = ["4:2.0:2.1"]
[record]
base_mva = 100.0
[compare]
reference = "one"
[terminal.one]
plant = "1"
record = "plant1.csv"
[terminal.two]
plant = "2"
record = "plant2.csv"
[terminal.eight]
plant = "8"
record = "plant8.csv"
[terminal.five]
bus = 5
record = "bus5.csv"
)";
    const auto replace = [&](const std::string& a, const std::string& b) {
      if (const auto at = text.find(a); !a.empty() && at != std::string::npos) text.replace(at, a.size(), b);
    };
    replace("RAW", test::source("configs/networks/ieee14_genrou.raw").string());
    replace("DYR", test::source("configs/networks/ieee14_genrou.dyr").string());
    replace(from, to);
    for (std::size_t at = 0; (at = text.find("record = ", at)) != text.npos; at += instruments.size() + 1)
      text.insert(at, instruments);
    std::ofstream(folder / "system.toml") << text;
    return folder / "system.toml";
  }
  const std::vector<std::string> same = {"all:TGOV1:R=0.05,T1=0.5", "all:SEXS"};
  std::string instruments;  ///< an additional line of every terminal
  fs::path folder;
};

TEST_F(SystemCompare, SameGridIsAdequate) {
  record({.attached = same});
  const SystemCase s = load_system(system());
  const SystemComparison c = compare_system(s);
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  EXPECT_EQ(c.switching_times, (std::vector<double>{2.0, 2.1}));
  ASSERT_EQ(c.terminals.size(), 4);  // sorted by name: eight, five, one, two
  std::vector<std::string> names;
  for (const auto& channel : c.terminals[3].channels) names.push_back(channel.name);
  EXPECT_EQ(names, (std::vector<std::string>{"V", "angle", "P", "Q"}));
  EXPECT_EQ(c.terminals[2].channels[1].name, "frequency");  // the reference terminal's
  EXPECT_EQ(c.terminals[1].channels.size(), 2);             // a bus: V and angle
  // Only the added noise of 2e-4: its RMS scatters by 1/sqrt(2 * 601) = 3 %; the tolerance is four times
  // that.
  for (const auto& channel : c.terminals[3].channels)
    if (channel.name != "angle") {
      EXPECT_NEAR(channel.whole.rms, 2e-4, 0.12 * 2e-4) << channel.name;
    }
  // The angle also contains the noise of the reference.
  EXPECT_NEAR(c.terminals[3].channels[1].whole.rms, std::sqrt(2.0) * 2e-4, 0.12 * std::sqrt(2.0) * 2e-4);
  for (const auto& r : c.ranking) EXPECT_LT(r.worst, 1);
}

TEST_F(SystemCompare, FrequencyMetersSuffice) {
  record({.attached = same, .noise = 1e-3, .meters = true});
  EXPECT_THAT(test::messages([&] { load_system(system()); }),
              Contains(HasSubstr("no angle in the record of one")));
  const fs::path file = system("reference = \"one\"", "");
  const SystemComparison right = compare_system(load_system(file));
  EXPECT_TRUE(right.adequacy.adequate) << right.adequacy.sentence;
  for (const auto& e : right.terminals) EXPECT_EQ(e.channels[1].name, "frequency");
  for (const TerminalRank& r : right.ranking) EXPECT_TRUE(!r.alone || r.alone->adequate) << r.alone->sentence;
  record({.attached = {"all:TGOV1:R=0.05,T1=0.5", "1:SEXS", "8:SEXS", "2:SEXS:K=20"},
          .noise = 1e-3,
          .meters = true});
  const SystemComparison wrong = compare_system(load_system(file));
  EXPECT_FALSE(wrong.adequacy.adequate);
  EXPECT_EQ(wrong.terminals[wrong.ranking.front().terminal].record.name, "two");
}
TEST_F(SystemCompare, SameGridIsAdequate_BehindFilters) {
  // The filter's effect on fast decays within the fault (0.002 pu of Q) lies below this noise.
  record({.attached = same, .t_on = 2.003, .t_off = 2.108, .noise = 1e-3, .window = 7});
  const SystemComparison c = compare_system(load_system(system("4:2.0:2.1", "4:2.003:2.108")));
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  for (const auto& e : c.terminals) {
    EXPECT_GE(std::ranges::count(e.left_out, 1), 4) << e.record.name;
    EXPECT_LE(std::ranges::count(e.left_out, 1), 14) << e.record.name;
  }
}
/// A simulation with 64 times the record's sampling rate, switched half-way between two of its own samples.
/// The filter is a triangle over two cycles.
constexpr double kTick = 1.0 / 3840, kOn = 7692.5 * kTick, kOff = 8096.5 * kTick;
constexpr int kWindow = 63, kFineness = 64;

TEST_F(SystemCompare, SameGridIsAdequate_BehindDeclaredFiltersAtLowNoise) {
  record({.attached = same, .t_on = kOn, .t_off = kOff, .window = kWindow, .fine = kFineness});
  const auto given = fmt::format("4:{:.7f}:{:.7f}", kOn, kOff);
  const SystemComparison undeclared = compare_system(load_system(system("4:2.0:2.1", given)));
  EXPECT_FALSE(undeclared.adequacy.adequate);  // 0.002 pu of Q in the fault
  instruments = "instruments = [\"PMUFILTER\"]\n";
  const SystemComparison c = compare_system(load_system(system("4:2.0:2.1", given)));
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  for (const auto& e :
       c.terminals) {  // excluded: a cycle of 50 Hz and a quarter of a sample on either side of two steps
    EXPECT_GE(std::ranges::count(e.left_out, 1), 4) << e.record.name;
    EXPECT_LE(std::ranges::count(e.left_out, 1), 6) << e.record.name;
  }
  EXPECT_NEAR(c.terminals[3].channels[3].whole.rms, 2e-4, 0.12 * 2e-4);  // as in SameGridIsAdequate
}
TEST_F(SystemCompare, DeclaredFiltersGiveSwitchingTimes) {
  record({.attached = same, .t_on = kOn, .t_off = kOff, .window = kWindow, .fine = kFineness});
  const auto found = system("[event]", "[event]\nswitching_times = \"found\"");
  const SystemComparison undeclared = compare_system(load_system(found));
  EXPECT_NEAR(undeclared.switching_times[0], kOn,
              2e-3);  // estimated from the samples after the filtered ones: errors of 0.6 and 0.4 ms
  EXPECT_NEAR(undeclared.switching_times[1], kOff, 2e-3);
  instruments = "instruments = [\"PMUFILTER\"]\n";
  const SystemComparison c =
      compare_system(load_system(system("[event]", "[event]\nswitching_times = \"found\"")));
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  EXPECT_NEAR(c.switching_times[0], kOn, 1e-4);
  EXPECT_NEAR(c.switching_times[1], kOff, 1e-4);
}
TEST_F(SystemCompare, NamesChangedGovernorFirst_WhenAllTerminalsSwing) {
  std::vector<std::string> changed = {"1:TGOV1:R=0.05,T1=0.5", "3:TGOV1:R=0.05,T1=0.5",
                                      "6:TGOV1:R=0.05,T1=0.5", "8:TGOV1:R=0.05,T1=0.5",
                                      "2:TGOV1:R=0.02,T1=0.2", "all:SEXS"};
  record({.attached = changed});
  const SystemCase s = load_system(system());
  const SystemComparison c = compare_system(s);
  EXPECT_FALSE(c.adequacy.adequate);
  EXPECT_EQ(s.terminals[c.ranking[0].terminal].name, "two");
  ASSERT_TRUE(c.ranking[0].alone.has_value());
  EXPECT_FALSE(c.ranking[0].alone->adequate);
  for (std::size_t k = 1; k < c.ranking.size(); ++k)
    if (c.ranking[k].alone) {
      EXPECT_TRUE(c.ranking[k].alone->adequate) << c.ranking[k].alone_where;
    }
  EXPECT_THAT(c.culprit, HasSubstr("The model of the plant at terminal two fails in playback"));
  EXPECT_THAT(system_text(s, c), HasSubstr(c.culprit));
  const auto j = nlohmann::json::parse(system_json(s, c, system_provenance(s, "command")));
  EXPECT_EQ(j["ranking"][0]["terminal"], "two");
  EXPECT_FALSE(j["adequate"]);
  EXPECT_EQ(j["terminals"][3]["channels"][2]["name"], "P");
  EXPECT_THAT(system_html(s, c, {}), HasSubstr("P residual"));
}

TEST_F(SystemCompare, GridErrorIsAttributedToNoPlant) {
  record({.attached = same});
  // In the simulation the fault is behind an impedance, in the records it is bolted.
  const SystemCase s = load_system(system("4:2.0:2.1\"", "4:2.0:2.1:0.01:0.02\""));
  const SystemComparison c = compare_system(s);
  EXPECT_FALSE(c.adequacy.adequate);
  EXPECT_THAT(c.culprit,
              HasSubstr("Every plant that could be played back is adequate with its recorded voltage"));
}

TEST_F(SystemCompare, FindsSwitchingTimesBetweenSamples) {
  record({.attached = same, .t_on = 2.013, .t_off = 2.107});
  const SystemComparison given = compare_system(load_system(system()));
  EXPECT_FALSE(given.adequacy.adequate);
  const SystemComparison c =
      compare_system(load_system(system("[event]", "[event]\nswitching_times = \"found\"")));
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  // Half a sample is 8.3 ms; P and Q after the fault determine the time to 5 % of that.
  EXPECT_NEAR(c.switching_times[0], 2.013, 4e-4);
  EXPECT_NEAR(c.switching_times[1], 2.107, 4e-4);
}

TEST_F(SystemCompare, DetectsClockOffset) {
  record({.attached = same, .t_on = 2.053, .t_off = 2.153});
  const SystemComparison c = compare_system(load_system(system()));
  EXPECT_FALSE(c.adequacy.adequate);
  EXPECT_THAT(c.terminals[3].notes, Contains(HasSubstr("not at the event's switching times")));
  // The plants are played in with the steps of their own records, so no plant is named.
  EXPECT_THAT(c.culprit,
              HasSubstr("Every plant that could be played back is adequate with its recorded voltage"));
}

TEST_F(SystemCompare, JudgesOrSubtractsSteadyStateDifference) {
  record({.attached = same, .shift_V = 0.003});
  const SystemComparison judged = compare_system(load_system(system()));
  EXPECT_FALSE(judged.adequacy.adequate);
  EXPECT_NEAR(judged.initial[4 * 3], -0.003, 1e-4);  // V of terminal two [pu]; noise of the mean 2e-5
  const SystemComparison shifted =
      compare_system(load_system(system("[compare]", "[compare]\nsteady_state = \"shift\"")));
  for (const auto& e : shifted.terminals)
    for (const auto& channel : e.channels) EXPECT_LT(std::abs(channel.whole.mean), 1e-4) << channel.name;
  EXPECT_TRUE(shifted.adequacy.adequate) << shifted.adequacy.sentence;
}

TEST_F(SystemCompare, AcceptsTerminalsSampledAtOtherTimes) {
  record({.attached = same});
  // Every second sample of plant 2, from the third on.
  std::ifstream in(folder / "plant2.csv");
  std::string line, kept;
  for (int k = -1; std::getline(in, line); ++k)
    if (k < 0 || (k >= 3 && k % 2 == 1)) kept += line + "\n";
  std::ofstream(folder / "plant2.csv") << kept;
  const SystemComparison c = compare_system(load_system(system("reference = \"one\"", "")));
  EXPECT_TRUE(c.adequacy.adequate) << c.adequacy.sentence;
  EXPECT_EQ(c.terminals[3].channels[1].name, "frequency");
  EXPECT_THAT(test::messages([&] { compare_system(load_system(system())); }),
              Contains(HasSubstr("angles with different sampling times")));
}

TEST_F(SystemCompare, ReportsBadInput) {
  record({.attached = same});
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"4:2.0:2.1", "99:2.0:2.1"}, "no bus 99"},
      {{"4:2.0:2.1", "4:2.0:99"}, "a fault that ends at 99 s"},
      {{"fault = [\"4:2.0:2.1\"]", ""}, "no event"},
      {{"plant = \"8\"", "plant = \"9\""}, "no plant 9"},
      {{"bus = 5", "bus = 77"}, "no bus 77"},
      {{"bus = 5", "bus = 5\nplant = \"1\""}, "either a plant or a bus"},
      {{"reference = \"one\"", "reference = \"zero\""}, "no terminal zero"},
      {{"base_mva = 100.0", "base_mva = -1"}, "base_mva"},
      {{"plant8.csv", "nowhere.csv"}, "nowhere.csv"},
      {{"[compare]", "[compare]\ncolour = 1"}, "colour"},
      {{"all:SEXS", "all:NOSUCH"}, "NOSUCH"},
      {{"ieee14_genrou.raw", "nowhere.raw"}, "nowhere.raw"},
      {{"bus = 5", "bus = 5\ninstruments = [\"SEXS\"]"}, "no measurement effect 'SEXS'"},
      {{"bus = 5", "bus = 5\ninstruments = [\"GAPS:rate=1\"]"}, "draws random numbers"},
      {{"bus = 5", "bus = 5\ninstruments = [\"PMUFILTER:class=1,reports=50\"]"}, "reports = 10, 12, 15"},
  };
  for (const auto& [change, words] : cases)
    EXPECT_THAT(test::messages([&, &change = change] { load_system(system(change.first, change.second)); }),
                Contains(HasSubstr(words)))
        << change.first;
  // A switching before the start of the run, and one without a pre-event period.
  EXPECT_THAT(test::messages([&] { compare_system(load_system(system("4:2.0:2.1", "4:-1:2.1"))); }),
              Contains(HasSubstr("a run starts at 0 s")));
  EXPECT_THAT(test::messages([&] { compare_system(load_system(system("4:2.0:2.1", "4:0.01:2.1"))); }),
              Contains(HasSubstr("samples before the event")));
}

}  // namespace
}  // namespace swingbank::validate::system
