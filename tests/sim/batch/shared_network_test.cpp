#include "sim/batch/detail/shared_network.hpp"

#include <gtest/gtest.h>

#include <map>

#include "sim/batch/batch.hpp"
#include "sim/batch/detail/switched_network.hpp"
#include "sim/reference/reference.hpp"
#include "tests/bench/synthetic_grid.hpp"
#include "tests/sim/batch/run_jobs.hpp"

namespace swingbank::sim::batch {
namespace {

constexpr int kMachines = 41;  // not a multiple of the row block
constexpr int kMost = SharedNetwork<P8>::most_products(kMachines);
constexpr std::size_t kSubtransient = 10;  // X'' among the parameters of GENROU

const grid::Grid& grid() {
  static const grid::Grid made = synthetic(kMachines);
  return made;
}

/// Matrix of a topology; the first `changed` machines have other impedances.
InternalMatrix matrix(const network::Topology& topology, int changed = 0) {
  const std::vector<double> r(kMachines, 0.002);
  std::vector<double> x(kMachines, 0.25);
  for (int i = 0; i < changed; ++i) x[static_cast<std::size_t>(i)] *= 1.02 + 0.01 * i;
  return InternalNetwork(grid()).matrix(topology, r, x);
}

/// Largest entry of the matrix `of` minus `from` minus the sum of the outer products.
double rest(const InternalMatrix& of, const InternalMatrix& from, const LowRank& products) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kMachines; ++i)
    for (std::size_t j = 0; j < kMachines; ++j) {
      Complex left(of.g[i * kMachines + j] - from.g[i * kMachines + j],
                   of.b[i * kMachines + j] - from.b[i * kMachines + j]);
      for (std::size_t k = 0; k < products.ur.size(); k += kMachines)
        left -=
            Complex(products.ur[k + i], products.ui[k + i]) * Complex(products.wr[k + j], products.wi[k + j]);
      largest = std::max(largest, std::abs(left));
    }
  return largest;
}

/// Number of outer products that express `of` minus the base matrix; -1: more than kMost.
int rank(const InternalMatrix& of) {
  const InternalMatrix from = matrix({});
  const auto found = difference(of, from, kMost);
  if (!found) return -1;
  EXPECT_LE(rest(of, from, *found), 1e-12);
  return found->rank;
}

TEST(LowRank, UpdatesAnEventByLowRankProducts) {
  EXPECT_EQ(rank(matrix({})), 0);
  EXPECT_EQ(rank(matrix({.faults = {{4, {}}}})), 1);
  EXPECT_EQ(rank(matrix({.faults = {{4, {0.01, 0.1}}}})), 1);
  EXPECT_EQ(rank(matrix({.faults = {{5, {}}}})), 1);  // at a machine's own bus
  EXPECT_EQ(rank(matrix({.open = {1}})), 1);
  EXPECT_EQ(rank(matrix({.tripped = {3}})), 1);
  EXPECT_EQ(rank(matrix({.load_steps = {{6, {0.3, 0.1}}}})), 1);
  EXPECT_EQ(rank(matrix({}, 1)), 1);
  EXPECT_EQ(rank(matrix({.faults = {{4, {}}}, .open = {1}}, 3)), 5);
  EXPECT_EQ(rank(matrix({.faults = {{4, {}}}}, kMost - 1)), kMost);
  EXPECT_EQ(rank(matrix({.faults = {{4, {}}}}, kMost)), -1);
}

TEST(LowRank, EachImpedanceChangeIsOneProduct) {
  for (const network::Topology& topology :
       {network::Topology{}, network::Topology{.faults = {{5, {}}}}, network::Topology{.tripped = {1}}}) {
    LowRank products;
    std::vector<ImpedanceChange> changes;
    for (int i = 0; i < 4; ++i) changes.push_back({i, {0.0, 0.25 * (0.02 + 0.01 * i)}});
    const InternalMatrix from = matrix(topology);
    add_impedances(products, from, changes);
    EXPECT_EQ(products.rank, 4);
    EXPECT_LE(rest(matrix(topology, 4), from, products), 1e-12);
    EXPECT_GE(rest(matrix(topology, 4), from, {}), 1e-3);
    auto both = *difference(from, matrix({}), kMost);  // added to existing products
    add_impedances(both, matrix({}), changes);
    EXPECT_LE(rest(matrix(topology, 4), matrix({}), both), 1e-12);
  }
}

TEST(SwitchedNetwork, MatchesANewReduction) {
  grid::Grid shifted = grid();  // no symmetric matrix
  shifted.network.branches[2].shift = 0.3;
  const std::vector<double> r(kMachines, 0.002), x(kMachines, 0.25);
  const SwitchedNetwork switched(shifted, r, x);
  InternalNetwork network(shifted);
  const InternalMatrix own = network.matrix({}, r, x);
  const auto off = [&](const network::Topology& topology) {
    const auto products = switched.change(topology, kMost);
    return products ? rest(network.matrix(topology, r, x), own, *products) : -1.0;
  };
  for (const network::Topology& topology :
       std::vector<network::Topology>{{},
                                      {.faults = {{4, {}}}},
                                      {.faults = {{5, {}}}},  // at a machine's own bus
                                      {.faults = {{4, {0.01, 0.1}}}},
                                      {.open = {1}},
                                      {.open = {2}},
                                      {.load_steps = {{6, {0.3, 0.1}}}},
                                      {.faults = {{0, {}}, {7, {}}}, .open = {1, 2}}}) {
    const double left = off(topology);
    EXPECT_GE(left, 0.0);
    EXPECT_LE(left, 1e-12);
  }
  EXPECT_EQ(off({.tripped = {3}}), -1.0);
  EXPECT_EQ(off({.partly_tripped = {{3, 0.5}}}), -1.0);
  EXPECT_FALSE(switched.change({.open = {1, 4, 6, 9, 11}}, 5));  // six buses
}

/// Voltage of every source and lane.
std::vector<P8> voltages(double phase) {
  std::vector<P8> e(kMachines);
  for (int i = 0; i < kMachines; ++i)
    for (int l = 0; l < 8; ++l) e[static_cast<std::size_t>(i)].set(l, std::cos(phase + 0.7 * i + 0.3 * l));
  return e;
}

TEST(BusFactors, RefuseMatricesThatNeedPivoting) {
  BusFactors::Sparse crossed(2, 2);
  crossed.insert(0, 1) = crossed.insert(1, 0) = 1.0;
  EXPECT_FALSE(BusFactors().factor(crossed));
}

/// Both forms of the shared network: rows of the reduced matrix, and factors of the whole network.
class SharedNetworkForms : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Both, SharedNetworkForms, testing::Bool());

TEST_P(SharedNetworkForms, EveryLaneHasTheCurrentsOfItsOwnMatrix) {
  const std::array<InternalMatrix, 8> lanes = {matrix({}),
                                               matrix({.faults = {{4, {}}}}),
                                               matrix({.faults = {{4, {}}}}, kMost),  // not a few products
                                               matrix({.open = {1}}, 3),
                                               matrix({}, kMachines),
                                               matrix({.tripped = {3}}),
                                               matrix({}, 1),
                                               matrix({.load_steps = {{6, {0.3, 0.1}}}})};
  SharedNetwork<P8> network;
  const SwitchedNetwork switched(grid(), std::vector<double>(kMachines, 0.002),
                                 std::vector<double>(kMachines, 0.25));
  BusFactors factors;
  ASSERT_TRUE(factors.factor(switched.closed()));
  network.assign(matrix({}));
  if (GetParam()) network.assign(factors, switched.plants());
  EXPECT_EQ(network.factored(), GetParam());
  const auto set = [&](int lane, const InternalMatrix& m) {
    if (const auto few = difference(m, matrix({}), kMost))
      network.set(lane, *few);
    else
      network.set(lane, m);
  };
  for (int l = 7; l >= 0; --l)
    set(l, lanes[static_cast<std::size_t>(l % 3)]);  // must be overwritten completely
  for (int l = 0; l < 8; ++l) set(l, lanes[static_cast<std::size_t>(l)]);
  const auto er = voltages(0.0), ei = voltages(1.0);
  std::vector<P8> ir(SharedRows::padded(kMachines)), ii = ir;
  network.solve(er.data(), ei.data(), ir.data(), ii.data());
  for (int l = 0; l < 8; ++l) {
    const InternalMatrix& m = lanes[static_cast<std::size_t>(l)];
    for (std::size_t i = 0; i < kMachines; ++i) {
      Complex sum;
      for (std::size_t j = 0; j < kMachines; ++j)
        sum += Complex(m.g[i * kMachines + j], m.b[i * kMachines + j]) * Complex(er[j][l], ei[j][l]);
      EXPECT_NEAR(ir[i][l], sum.real(), 1e-12) << "lane " << l;
      EXPECT_NEAR(ii[i][l], sum.imag(), 1e-12) << "lane " << l;
    }
  }
  for (int of = 0; of < 8; ++of) {  // all lanes are samples of one event
    if (network.whole(of)) continue;
    network.solve_of(of, er.data(), ei.data(), ir.data(), ii.data());
    const InternalMatrix& m = lanes[static_cast<std::size_t>(of)];
    for (int l = 0; l < 8; ++l)
      for (int i = 0; i < kMachines; ++i) {
        Complex sum;
        const Eigen::VectorXcd row = m.row(i);
        for (int j = 0; j < kMachines; ++j)
          sum += row[j] * Complex(er[static_cast<std::size_t>(j)][l], ei[static_cast<std::size_t>(j)][l]);
        EXPECT_NEAR(ir[static_cast<std::size_t>(i)][l], sum.real(), 1e-12) << "event of lane " << of;
        EXPECT_NEAR(ii[static_cast<std::size_t>(i)][l], sum.imag(), 1e-12) << "event of lane " << of;
      }
  }
}

TEST(SwitchedNetwork, GivesRowsAndColumnsOfTheReducedMatrix) {
  grid::Grid shifted = grid();  // no symmetric matrix
  shifted.network.branches[2].shift = 0.3;
  const std::vector<double> r(kMachines, 0.002), x(kMachines, 0.25);
  const SwitchedNetwork switched(shifted, r, x);
  ASSERT_TRUE(switched.sound());
  const InternalMatrix own = InternalNetwork(shifted).matrix({}, r, x);
  for (const int k : {0, 1, 17}) {
    EXPECT_LE((switched.row(k) - own.row(k)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LE((switched.column(k) - own.column(k)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

/// Jobs with faults, opened lines, lost generators, load steps and changed machine impedances. The changed
/// machines are up to two, or kMost (a fault then exceeds the number of products), or all.
std::vector<Job> jobs() {
  std::vector<Job> list(20);
  for (std::size_t k = 0; k < list.size(); ++k) {
    Job& job = list[k];
    const int at = static_cast<int>(k);
    job.id = k;
    if (k != 7) job.event.faults = {{3 * at, 0.2, 0.23 + 0.002 * at, {}}};
    if (k % 4 == 1) job.event.trips = {{5 * at + 1, 0.3, 0.6 + 0.01 * at}};
    if (k % 6 == 4) job.event.generator_trips = {{30, 0.35, k == 4 ? 1.0 : 0.4}};
    if (k % 6 == 5) job.event.load_steps = {{20, {0.3, 0.1}, 0.15, 0.7}};
    const int changed = k % 5 == 2 ? kMachines : k % 5 == 3 ? kMost : at % 3;
    for (int i = 0; i < changed; ++i) {
      auto p = grid().plants[static_cast<std::size_t>(i)].machine.p;
      p[kSubtransient] *= 0.9 + 0.005 * ((i + at) % 8);
      job.parameters.push_back({i, plant::kMachineBlock, p});
    }
  }
  return list;
}

std::map<std::uint64_t, Trajectory> run_all(const std::vector<Job>& list, BatchOptions options) {
  static_assert(kMachines >= SharedNetwork<P8>::kMany);
  options.t_end = 1.0;
  return run_jobs(grid(), list, options);
}

TEST(BatchOfManySources, EqualRunsWithAMatrixEach) {
  BatchOptions one, eight;
  one.lanes = 1;  // no shared network
  eight.lanes = 8;
  const auto a = run_all(jobs(), one), b = run_all(jobs(), eight);
  eight.plants = {17, 2};
  const auto two = run_all(jobs(), eight);
  for (const auto& [id, t] : a) {
    ASSERT_EQ(t.outcome, Outcome::stable) << id;
    const auto x = t.packed(), y = b.at(id).packed();
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], 1e-9) << id;
    for (int p = 0; p < 2; ++p)
      for (int c = 0; c < kChannelCount; ++c)
        for (int k = 0; k < t.samples; ++k)
          ASSERT_NEAR(t.at(eight.plants[static_cast<std::size_t>(p)], c)[k], two.at(id).at(p, c)[k], 1e-9);
  }
}

TEST(BatchOfManySources, AgreeWithTheReference) {
  std::vector<Job> list = jobs();
  std::erase_if(list, [](const Job& job) { return job.id != 5 && job.id != 10; });
  for (Job& job : list) job.parameters.clear();
  reference::ReferenceOptions options;
  options.t_end = 1.0;
  for (const auto& [id, t] : run_all(list, {})) {
    const auto& job = *std::ranges::find(list, id, &Job::id);
    const auto x = t.packed(), y = reference::run_reference(grid(), job.event, options).packed();
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], 1e-4) << id;
  }
}

TEST(BatchOfManySources, ARecordDoesNotDependOnItsLaneOrNeighbours) {
  auto list = jobs();
  for (const int lanes : {4, 8}) {
    BatchOptions options;
    options.lanes = lanes;
    const auto forward = run_all(list, options);
    std::reverse(list.begin(), list.end());
    const auto backward = run_all(list, options);
    for (const Job& job : list) {
      const auto alone = run_all({job}, options);
      EXPECT_EQ(forward.at(job.id).packed(), backward.at(job.id).packed()) << job.id;  // to the last bit
      EXPECT_EQ(forward.at(job.id).packed(), alone.at(job.id).packed()) << job.id;
    }
  }
}

}  // namespace
}  // namespace swingbank::sim::batch
