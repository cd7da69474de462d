// Three-winding transformers against their definition: the star of the measured impedances behind the ratios.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/network/admittance.hpp"
#include "tests/sim/formats/flatten.hpp"
#include "tests/sim/formats/raw_case.hpp"
#include "tests/sim/formats/write_raw.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

RawCase with(const std::string& transformer) {
  RawCase c;
  c.buses =
      "101,'HIGH',110.0,3,1,1,1,1.05,0.0\n102,'MID',20.0,2,1,1,1,1.02,-0.9\n"
      "103,'LOW',10.0,1,1,1,1,0.99,-8.7\n";
  c.branches = "";
  c.transformers = transformer;
  return c;
}

// Measured between pairs, in per unit on 100 MVA: 1-2 0.003 + j0.08, 2-3 0.006 + j0.14, 3-1 0.005 + j0.12.
// Ratios 1.04, 0.97, 1.01, phase 0, 30, -30 degrees.
const std::array<Complex, 3> kPairs{Complex(0.003, 0.08), {0.006, 0.14}, {0.005, 0.12}};

/// Admittance seen from the three buses: winding ratios, star of half sums, star point eliminated.
Eigen::Matrix3cd expected() {
  const auto [a, b, c] = kPairs;
  const std::array<Complex, 3> y{2.0 / (a + c - b), 2.0 / (a + b - c), 2.0 / (b + c - a)};
  const std::array<Complex, 3> n{std::polar(1.04, 0.0), std::polar(0.97, std::numbers::pi / 6),
                                 std::polar(1.01, -std::numbers::pi / 6)};
  const Complex sum = y[0] + y[1] + y[2];
  Eigen::Matrix3cd m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const auto u = static_cast<std::size_t>(i), v = static_cast<std::size_t>(k);
      m(i, k) = ((i == k ? y[u] : 0.0) - y[u] * y[v] / sum) / (std::conj(n[u]) * n[v]);
    }
  return m;
}
Eigen::Matrix3cd seen(const network::Network& n) {
  const Eigen::MatrixXcd y = network::bus_admittance(n);
  return y.topLeftCorner(3, 3) - y.topRightCorner(3, 1) * y.bottomLeftCorner(1, 3) / y(3, 3);
}

struct Coding {
  const char *name, *text;
};
class PsseThreeWindings : public ::testing::TestWithParam<Coding> {};
TEST_P(PsseThreeWindings, GiveTheSameAdmittance) {
  const network::Network n = with(GetParam().text).read();
  ASSERT_EQ(n.buses.size(), 4u);
  EXPECT_EQ(n.buses[3].number, 104);
  EXPECT_DOUBLE_EQ(n.buses[3].vm, 0.98);
  // Rounding of admittances of order 20.
  EXPECT_LT((seen(n) - expected()).cwiseAbs().maxCoeff(), 1e-12);
  for (const int version : {32, 33, 34, 35}) expect_same(n, parse_raw(raw_text(n, version), "out.raw"));
}
// Load losses in W: R on the pair's own base times that base.
INSTANTIATE_TEST_SUITE_P(
    Codes, PsseThreeWindings,
    ::testing::Values(
        Coding{"SystemBase",
               "101,102,103,'T',1,1,1,0,0,2,'',1\n"
               "0.003,0.08,200,0.006,0.14,200,0.005,0.12,200,0.98,-3\n1.04,0,0\n0.97,0,30\n1.01,0,-30\n"},
        Coding{"OwnBases",
               "101,102,103,'T',1,2,1,0,0,2,'',1\n"
               "0.006,0.16,200,0.003,0.07,50,0.0125,0.3,250,0.98,-3\n1.04,0,0\n0.97,0,30\n1.01,0,-30\n"},
        Coding{"KiloVolt",
               "101,102,103,'T',2,1,1,0,0,2,'',1\n"
               "0.003,0.08,100,0.006,0.14,100,0.005,0.12,100,0.98,-3\n114.4,0,0\n19.4,0,30\n10.1,0,-30\n"},
        Coding{"Nominal",
               "101,102,103,'T',3,1,1,0,0,2,'',1\n0.003,0.08,100,0.006,0.14,100,0.005,0.12,100,0.98,-3\n"
               "1.0,114.4,0\n0.97,20,30\n1.01,0,-30\n"},
        Coding{"LoadLoss",
               "101,102,103,'T',1,3,1,0,0,2,'',1\n"
               "1.2e6,0.160112460477003475,200,1.5e5,0.070064256222413436,50,3.125e6,0.300260303736607846,"
               "250,0.98,-3\n"
               "1.04,0,0\n0.97,0,30\n1.01,0,-30\n"}),
    [](const auto& test) { return test.param.name; });

TEST(PsseThreeWindingsStatus, SelectsTheWindingOutOfService) {
  const auto in = [](int status) {
    std::array<bool, 3> on{};
    const network::Network n = with("101,102,103,'T',1,1,1,0.001,-0.002,2,''," + std::to_string(status) +
                                    "\n0.003,0.08,100,0.006,0.14,100,0.005,0.12,100\n1\n1\n1\n")
                                   .read();
    for (std::size_t i = 0; i < 3; ++i) on[i] = n.branches[i].in_service;
    EXPECT_EQ(n.buses[3].type == network::BusType::isolated, status == 0);
    EXPECT_EQ(n.branches[0].shunt_from, Complex(0.001, -0.002));
    return on;
  };
  using All = std::array<bool, 3>;
  EXPECT_EQ(in(0), (All{false, false, false}));
  EXPECT_EQ(in(1), (All{true, true, true}));
  EXPECT_EQ(in(2), (All{true, false, true}));
  EXPECT_EQ(in(3), (All{true, true, false}));
  EXPECT_EQ(in(4), (All{false, true, true}));
}

TEST(PsseThreeWindingsFaults, AreReportedWithLine) {
  const RawCase c = with(
      "101,102,103,'T',1,1,1,0,0,2,'',7\n0.0,0.1,100,0.0,0.3,100,0.0,0.2,100,0,0\n1.04,0,0\n0.97,0,30\n"
      "1.01,0,-30,0,0,0,0,0,0,0,0,0,0,5\n101,102,102,'U',1,1,1\n0,0.1,100,0,0.1,100,0,0.1,100\n1\n1\n1\n");
  const std::string all = sentences_of([&] { c.read(); });
  const int first = line_of(c.text(), "101,102,103,'T'");
  for (const auto& [what, offset] :
       {std::pair{"STAT = 7", 0}, {"TAB3 = 5", 4}, {"two windings at one bus", 5}})
    EXPECT_THAT(all, ::testing::ContainsRegex(std::string(what) +
                                              " at [^ ]*case.raw:" + std::to_string(first + offset) + " "));
}

}  // namespace
}  // namespace swingbank::sim::formats
