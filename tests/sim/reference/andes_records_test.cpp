// The reference integrator against records of ANDES (origin: tests/reference/README.md).

#include "base/json.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference {
namespace {

/// Tolerance per channel [rad, pu, pu on 100 MVA, pu on 100 MVA, pu, rad, pu]. ANDES's own error is up to
/// 3e-6 rad and 3e-5 pu. The limits of delta, P, Q and V are required. The others follow: speed is the
/// derivative of an angle accurate to 1e-4 rad at swings of 10 rad/s, divided by 377 rad/s. theta has the
/// limit of delta, and Ifd that of Q.
struct Limit {
  const char* name;
  Channel channel;
  double tolerance;
};
constexpr Limit kLimits[] = {{"delta_rad", Channel::delta, 1e-4}, {"omega_pu", Channel::speed, 3e-6},
                             {"Pe_pu", Channel::P, 2e-4},         {"Qe_pu", Channel::Q, 2e-4},
                             {"Vt_pu", Channel::V, 1e-4},         {"theta_rad", Channel::theta, 1e-4},
                             {"Ifd_pu", Channel::Ifd, 2e-4}};

class AndesRecord {
 public:
  explicit AndesRecord(const std::string& name) {
    const std::filesystem::path folder = std::filesystem::path(SWINGBANK_SOURCE) / "tests/reference/andes";
    std::ifstream in(folder / (name + ".json"));
    json = nlohmann::json::parse(in);
    table = test::read_table(folder / (name + ".csv"), true);
  }
  nlohmann::json json;
  test::Table table;
};

/// Swingbank's value of a channel in ANDES's units: speed about 1, powers on 100 MVA.
double in_their_units(Channel channel, double value, double mva) {
  if (channel == Channel::speed) return 1.0 + value;
  return channel == Channel::P || channel == Channel::Q ? value * mva / 100.0 : value;
}

class AndesRecords : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string name = GetParam();
    grid_ = test::configured_grid(name.substr(0, name.rfind('_')), Conventions::andes());
    const auto& f = record_.json["fault"];
    event_.faults.push_back({grid_.network.bus_index(f["bus"]), f["t_on"], f["t_off"], {f["rf"], f["xf"]}});
    options_.rate = record_.json["rate"];
  }
  void compare(const plant::Plant& plant, const Limit& limit, double ours, double theirs, double t) {
    const double difference = in_their_units(limit.channel, ours, plant.mva) - theirs;
    EXPECT_LE(std::abs(difference), limit.tolerance)
        << plant.name << "." << limit.name << " at " << t << " s";
    worst_[limit.name] = std::max(worst_[limit.name], std::abs(difference));
  }
  void TearDown() override {
    for (const auto& [name, value] : worst_) RecordProperty("largest_" + name, testing::PrintToString(value));
  }
  AndesRecord record_{GetParam()};
  grid::Grid grid_;
  network::Event event_;
  ReferenceOptions options_;
  std::map<std::string, double> worst_;
};

TEST_P(AndesRecords, AgreeAtEverySample) {
  const ReferenceRun run = run_reference(grid_, event_, options_);
  ASSERT_EQ(run.outcome, Outcome::stable);
  ASSERT_GT(record_.table.rows.size(), 100u);
  for (std::size_t p = 0; p < grid_.plants.size(); ++p)
    for (const Limit& limit : kLimits) {
      const int column = record_.table.column("g" + grid_.plants[p].name + "_" + limit.name);
      if (column < 0 && limit.channel == Channel::Ifd) continue;  // the classical machine has none
      ASSERT_GE(column, 0) << limit.name;
      for (const auto& row : record_.table.rows) {
        const auto k = static_cast<int>(std::lround(row[0] * run.rate));
        compare(grid_.plants[p], limit, run.at(static_cast<int>(p), static_cast<int>(limit.channel))[k],
                row[static_cast<std::size_t>(column)], row[0]);
      }
    }
}

TEST_P(AndesRecords, AgreeJustAfterSwitching) {
  options_.after_switching = true;
  const ReferenceRun run = run_reference(grid_, event_, options_);
  ASSERT_EQ(record_.json["right_limits"].size(), 2u);
  for (const auto& [time, units] : record_.json["right_limits"].items()) {
    const auto k = static_cast<int>(std::lround(std::stod(time) * run.rate));
    for (std::size_t p = 0; p < grid_.plants.size(); ++p)
      for (const Limit& limit : kLimits) {
        const auto& unit = units.at(grid_.plants[p].name);
        if (!unit.contains(limit.name)) continue;
        compare(grid_.plants[p], limit, run.at(static_cast<int>(p), static_cast<int>(limit.channel))[k],
                unit[limit.name], std::stod(time));
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, AndesRecords,
                         testing::Values("ieee39_gencls_ev1", "ieee39_gencls_ev2", "ieee39_genrou_ev1",
                                         "ieee39_genrou_ev2", "ieee14_genrou_ev1"),
                         [](const auto& record) { return std::string(record.param); });

}  // namespace
}  // namespace swingbank::sim::reference
