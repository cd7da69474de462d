#include "sim/network/admittance.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/network/branch_index.hpp"

namespace swingbank::sim::network {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Gaussian elimination with row pivoting; shares nothing with the code under test.
std::vector<Complex> solve(std::vector<std::vector<Complex>> a, std::vector<Complex> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t p = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[p][k])) p = i;
    std::swap(a[k], a[p]);
    std::swap(b[k], b[p]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Complex f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

class Reduction : public ::testing::Test {
 protected:
  Reduction() {
    for (const Generator& g : network.generators) kept.push_back(g.bus);
  }
  Network network = formats::read_raw(std::string(SWINGBANK_SOURCE) + "/configs/networks/ieee39_genrou.raw");
  PowerFlow flow = solve_power_flow(network);
  std::vector<int> kept;

  /// Currents at the kept buses for voltages `v`, from the full matrix: all other buses have no injection,
  /// and bolted buses have V = 0.
  [[nodiscard]] Eigen::VectorXcd by_hand(const Topology& topology, const Eigen::VectorXcd& v) const {
    const auto y = dynamic_admittance(network, flow, topology);
    const auto n = network.buses.size();
    std::vector<std::vector<Complex>> full(n, std::vector<Complex>(n));
    for (int j = 0; j < y.outerSize(); ++j)
      for (Eigen::SparseMatrix<Complex>::InnerIterator e(y, j); e; ++e)
        full[static_cast<std::size_t>(e.row())][static_cast<std::size_t>(j)] = e.value();
    auto a = full;
    std::vector<Complex> b(n);
    const auto fix = [&](int bus, Complex value) {
      auto& row = a[static_cast<std::size_t>(bus)];
      std::ranges::fill(row, Complex{});
      row[static_cast<std::size_t>(bus)] = 1.0;
      b[static_cast<std::size_t>(bus)] = value;
    };
    for (std::size_t k = 0; k < kept.size(); ++k) fix(kept[k], v[static_cast<Eigen::Index>(k)]);
    for (const int bus : grounded_buses(network, topology)) fix(bus, 0.0);
    const auto voltage = solve(a, b);
    Eigen::VectorXcd current = Eigen::VectorXcd::Zero(v.size());
    for (std::size_t k = 0; k < kept.size(); ++k)
      for (std::size_t j = 0; j < n; ++j)
        current[static_cast<Eigen::Index>(k)] += full[static_cast<std::size_t>(kept[k])][j] * voltage[j];
    return current;
  }
  [[nodiscard]] Eigen::VectorXcd some_voltages() const {
    Eigen::VectorXcd v(static_cast<Eigen::Index>(kept.size()));
    for (Eigen::Index k = 0; k < v.size(); ++k)
      v[k] = std::polar(1.0 + 0.01 * static_cast<double>(k), 0.2 * static_cast<double>(k));
    return v;
  }
};
constexpr double kRounding = 1e-10;  // entries of order 1e2, a solve of 39 equations

TEST_F(Reduction, EqualsTheFullSolution) {
  const int line = branch_index(network, 16, 17, "1");
  for (const Topology& t :
       {Topology{}, Topology{{{network.bus_index(16), {}}}, {}},
        Topology{{{network.bus_index(16), {0.01, 0.02}}, {network.bus_index(4), {}}}, {line}}}) {
    const auto v = some_voltages();
    const auto reduced = reduce(network, flow, t, kept);
    EXPECT_LT((reduced.y * v - by_hand(t, v)).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_THAT(reduced.grounded, IsEmpty());
  }
}

TEST_F(Reduction, GivesTheGeneratorCurrentsOfThePowerFlow) {
  const auto reduced = reduce(network, flow, {}, kept);
  Eigen::VectorXcd v(static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    v[static_cast<Eigen::Index>(k)] = flow.voltage[static_cast<std::size_t>(kept[k])];
  const Eigen::VectorXcd i = reduced.y * v;
  for (std::size_t k = 0; k < kept.size(); ++k)
    EXPECT_LT(std::abs(v[static_cast<Eigen::Index>(k)] * std::conj(i[static_cast<Eigen::Index>(k)]) -
                       flow.generation[k]),
              kRounding);
}

TEST_F(Reduction, ABoltedGeneratorBusIsGrounded) {
  const Topology t{{{kept[3], {}}}, {}};
  const auto reduced = reduce(network, flow, t, kept);
  EXPECT_THAT(reduced.grounded, ElementsAre(3));
  EXPECT_EQ(reduced.y.row(3).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(reduced.y.col(3).cwiseAbs().maxCoeff(), 0.0);
  auto v = some_voltages();
  v[3] = 0.0;
  Eigen::VectorXcd expected = by_hand(t, v);
  expected[3] = 0.0;  // the current into the fault is not compared
  EXPECT_LT((reduced.y * v - expected).cwiseAbs().maxCoeff(), kRounding);
}

TEST_F(Reduction, AFaultImpedanceConvergesLinearlyToTheBoltedFault) {
  const int bus = network.bus_index(16);
  const auto solid = reduce(network, flow, {{{bus, {}}}, {}}, kept).y;
  const std::vector<double> reactances = {1e-4, 1e-5, 1e-6, 1e-7};
  std::vector<double> gap;
  for (const double x : reactances)
    gap.push_back((reduce(network, flow, {{{bus, {0.0, x}}}, {}}, kept).y - solid).cwiseAbs().maxCoeff());
  for (std::size_t k = 1; k < gap.size(); ++k)
    // The quadratic term, relative to the linear one, is x times the driving-point admittance of the faulted
    // bus, about 110 pu.
    EXPECT_NEAR(gap[k - 1] / gap[k], 10.0, 10.0 * 150.0 * reactances[k - 1]);
  EXPECT_LT(gap.back(), 1e-4);
}

TEST_F(Reduction, IslandsWithoutGeneratorAreGrounded) {
  // Buses 7 and 8 are connected by 6-7, 5-8 and 8-9; bus 9 keeps 9-39.
  const std::vector<std::pair<int, int>> lines = {{6, 7}, {5, 8}, {8, 9}};
  Topology t;
  for (const auto& [a, b] : lines) t.open.push_back(branch_index(network, a, b, "1"));
  std::ranges::sort(t.open);
  for (const int i : t.open) ASSERT_GE(i, 0);
  EXPECT_THAT(dead_buses(network, t), ElementsAre(network.bus_index(7), network.bus_index(8)));
  EXPECT_EQ(grounded_buses(network, t), dead_buses(network, t));
  const auto v = some_voltages();
  const auto reduced = reduce(network, flow, t, kept);
  EXPECT_LT((reduced.y * v - by_hand(t, v)).cwiseAbs().maxCoeff(), kRounding);
  for (std::size_t k = 0; k < network.generators.size(); ++k) t.tripped.push_back(static_cast<int>(k));
  EXPECT_THAT(formats::sentences_of([&] { reduce(network, flow, t, kept); }),
              HasSubstr("the trips leave no generator in service"));
}

TEST_F(Reduction, IslandWithAGeneratorContinues) {
  const Topology t{{}, {branch_index(network, 2, 30, "1")}};  // generator 30 loses its only branch
  const auto reduced = reduce(network, flow, t, kept);
  EXPECT_LT(reduced.y.row(0).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(Reduction, IsolatedBusHasNoInfluence) {
  const auto before = reduce(network, flow, {}, kept).y;
  network.buses.push_back({99, "ISOLATED", 1.0, BusType::isolated, 1.0, 0.0});
  flow.voltage.push_back(0.0);
  EXPECT_LT((reduce(network, flow, {}, kept).y - before).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BusAdmittance, IncludesTapPhaseShiftAndLineShunts) {
  formats::RawCase c;
  c.branches = "101,103,'1',0.01,0.1,0.2,1,1,1,0.001,0.002,0.003,0.004\n102,103,'1',0,0.12\n";
  c.transformers = "101,102,0,'1',1,1,1,0.005,-0.006,2,'',1\n0.02,0.2\n1.1,0,30\n1.0,0\n";
  const Eigen::MatrixXcd y = bus_admittance(c.read());
  const Complex line = 1.0 / Complex(0.01, 0.1), trafo = 1.0 / Complex(0.02, 0.2),
                n = std::polar(1.1, M_PI / 6);
  constexpr double rounding = 1e-13;
  EXPECT_LT(std::abs(y(0, 0) - (line + Complex(0.001, 0.102) + trafo / 1.21 + Complex(0.005, -0.006))),
            rounding);
  EXPECT_LT(std::abs(y(0, 2) + line), rounding);
  EXPECT_LT(std::abs(y(0, 1) + trafo / std::conj(n)), rounding);
  EXPECT_LT(std::abs(y(1, 0) + trafo / n), rounding);
  EXPECT_LT(std::abs(y(2, 2) - (line + Complex(0.003, 0.104) + 1.0 / Complex(0, 0.12))), rounding);
}

}  // namespace
}  // namespace swingbank::sim::network
