// What laws compute against compiled effects, in every scalar and in both integrators.
#include <random>

#include "sim/lanes/batch.hpp"
#include "sim/laws/detail/definition.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/laws/support.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::laws {
namespace {

using test::kHead;
using test::law_of;
using test::sexs_law;

// against the compiled exciter
grid::Grid with_exciter(const Effect& exciter, std::vector<double> p) {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  grid.plants[1].controls = {{&exciter, std::move(p)}};
  return grid;
}
const network::Event kFault{{{1, 0.5, 0.65, {0.0, 0.05}}}, {}};
Trajectory lanes_run(const grid::Grid& grid, int lanes, double tolerance = 1e-6) {
  lanes::BatchOptions options;
  options.t_end = 5.0;
  options.lanes = lanes;
  options.tolerance = tolerance;
  options.plants = {1};
  lanes::Batch batch(grid, options);
  Trajectory run;
  bool given = false;
  batch.run([&](lanes::Job& job) { return job.event = kFault, !std::exchange(given, true); },
            [&](const lanes::Job&, const Trajectory& t) { run = t; });
  return run;
}
reference::ReferenceRun reference_run(const grid::Grid& grid, double rtol = 1e-8) {
  reference::ReferenceOptions options;
  options.t_end = 5.0;
  options.rtol = rtol;
  options.atol = rtol / 100;
  options.plants = {1};  // the other stands behind 1e-4 pu, which magnifies its voltage's rounding
  return reference::run_reference(grid, kFault, options);
}

TEST(LawFile, SexsAsALawEqualsTheCompiledOne) {
  const std::vector<std::vector<double>> sets = {{0.1, 10.0, 100.0, 0.1, -4.0, 5.0},  // runs into the ceiling
                                                 {0.5, 2.0, 20.0, 0.05, -10.0, 10.0},  // does not
                                                 {1.0, 0.0, 50.0, 0.2, -4.0, 4.0}};    // lead-lag bypassed
  bool reached = false;
  for (const auto& p : sets) {
    const grid::Grid compiled = with_exciter(*library::compiled().find("SEXS"), p),
                     law = with_exciter(sexs_law(), p);
    for (const int lanes : {1, 4, 8}) {
      const Trajectory a = lanes_run(compiled, lanes), b = lanes_run(law, lanes);
      EXPECT_LE(test::largest_difference(a, b), 1e-10) << lanes;  // the same arithmetic in the same order
      const double* efd = a.at(0, static_cast<int>(Channel::Efd));
      reached = reached || *std::max_element(efd, efd + a.samples) == p[5];
    }
    // The compiler contracts a product and a sum where the interpreter rounds twice; IDA then takes other
    // steps, so the tolerance is held far below what is compared.
    EXPECT_LE(test::largest_difference(reference_run(compiled, 1e-12), reference_run(law, 1e-12)), 1e-10);
  }
  EXPECT_TRUE(reached);
}

/// The same exciter by expressions: states, derivatives, an explicit reference.
constexpr const char* kByExpressions = R"law(
name = "SEXSBYHAND"
title = "SEXS by expressions"
source = "test"
output = "Efd"
action = "replace"
value = "efd"
[references]
Vref = "Efd0 / K + Vc0 - Vs0 - Vlimiter0"
[signals]
error = "Vref + dVref - Vc + Vs + Vlimiter"
ahead = "leadlag + TAoverTB * (error - leadlag)"
[states.leadlag]
unit = "pu"
meaning = "lead-lag"
derivative = "(error - leadlag) / TB"
[states.efd]
unit = "pu"
meaning = "field voltage"
derivative = "(K * ahead - efd) / TE"
low = "EMIN"
high = "EMAX"
[parameters]
TAoverTB = { unit = "-", standard = 0.1, low = 0.0, high = 10.0, meaning = "lead over lag" }
TB = { unit = "s", standard = 10.0, low = 0.001, high = 100.0, meaning = "lag" }
K = { unit = "pu", standard = 100.0, low = 0.5, high = 2000.0, meaning = "gain" }
TE = { unit = "s", standard = 0.1, low = 0.001, high = 5.0, meaning = "exciter" }
EMIN = { unit = "pu", standard = -4.0, low = -100.0, high = 0.0, meaning = "lower" }
EMAX = { unit = "pu", standard = 5.0, low = 0.5, high = 100.0, meaning = "upper" }
)law";
/// And as a transfer function with a clamp behind it (which winds up).
constexpr const char* kByTransferFunction = R"law(
name = "SEXSBYTF"
title = "SEXS by transfer function"
source = "test"
output = "Efd"
action = "replace"
input = "Vref + dVref - Vc + Vs + Vlimiter"
chain = ["exciter"]
[references]
Vref = "solve"
[blocks.exciter]
kind = "transfer_function"
numerator = ["K", "K * TAoverTB * TB"]
denominator = ["1", "TB + TE", "TB * TE"]
[parameters]
TAoverTB = { unit = "-", standard = 0.1, low = 0.0, high = 10.0, meaning = "lead over lag" }
TB = { unit = "s", standard = 10.0, low = 0.001, high = 100.0, meaning = "lag" }
K = { unit = "pu", standard = 100.0, low = 0.5, high = 2000.0, meaning = "gain" }
TE = { unit = "s", standard = 0.1, low = 0.001, high = 5.0, meaning = "exciter" }
)law";

TEST(LawFile, ThreeWaysOfWritingAnExciterAgree) {
  const std::vector<double> p = {0.5, 2.0, 20.0, 0.05, -10.0, 10.0};
  const reference::ReferenceRun compiled = reference_run(with_exciter(*library::compiled().find("SEXS"), p));
  const Effect by_expressions = make_law(kByExpressions, "e"),
               by_transfer_function = make_law(kByTransferFunction, "t");
  // Other unknowns and other roundings: what two runs at rtol 1e-8 differ by.
  EXPECT_LE(test::largest_difference(compiled, reference_run(with_exciter(by_expressions, p))), 1e-6);
  const grid::Grid tf = with_exciter(by_transfer_function, {0.5, 2.0, 20.0, 0.05});
  EXPECT_LE(test::largest_difference(compiled, reference_run(tf)), 1e-6);
}

TEST(LawFile, ALimitedStateDoesNotWindUp) {
  test::ControlBench bench(sexs_law(),
                           {{"TAoverTB", 1.0}, {"K", 10.0}, {"TE", 0.5}, {"EMAX", 3.0}, {"EMIN", 0.0}});
  ASSERT_EQ(bench.refused, "");
  EXPECT_LE(bench.largest_derivative(),
            1e-13);      // rounding of K y = 2 over TE: some 10 ulp, with or without FMA
  bench.in.dVref = 1.0;  // asks for Efd = 12
  bench.run(10.0);
  EXPECT_EQ(bench.out().Efd, 3.0);
  bench.in.dVref = 0.0;  // back to 2: it leaves the ceiling at once, e-folding 0.5 s
  bench.run(0.5);
  EXPECT_NEAR(bench.out().Efd, 2.0 + std::exp(-1.0), 1e-9);  // Runge-Kutta at TE / 500
}

// a nonlinear law, in every scalar
constexpr const char* kNonlinear = R"law(
name = "NONLINEAR"
title = "a bit of everything"
source = "test"
output = "Vs"
action = "replace"
value = "clamp(K * washed * abs(washed) + 0.05 * sin(square), -limit, limit)"
[signals]
e = "deadband(speed, band) * 50 + (P - P0)"
washed = "e - x"
[states.x]
unit = "pu"
meaning = "washout"
derivative = "(e - x) / T"
[states.square]
unit = "pu"
meaning = "rests at sqrt(V): found by Newton's method"
derivative = "10 * (V - square^2) + 0.1 * min(washed, max(e, -0.1))"
start = "1"
[parameters]
K = { unit = "pu", standard = 5.0, low = 0.0, high = 100.0, neutral = 0.0, meaning = "gain" }
T = { unit = "s", standard = 2.0, low = 0.1, high = 100.0, meaning = "washout" }
band = { unit = "pu", standard = 0.0005, low = 0.0, high = 0.1, meaning = "dead-band" }
limit = { unit = "pu", standard = 0.1, low = 0.01, high = 1.0, meaning = "limit" }
)law";
grid::Grid nonlinear_grid() {
  grid::Grid grid = with_exciter(*library::compiled().find("SEXS"), {0.5, 2.0, 20.0, 0.05, -10.0, 10.0});
  const Effect& law = load_law(kNonlinear, "n", grid.library);
  grid.plants[1].controls.insert(grid.plants[1].controls.begin(), {&law, law.standard_parameters()});
  return grid;
}

TEST(LawFile, ANonlinearLawRunsInEveryKernel) {
  const grid::Grid grid = nonlinear_grid();
  const auto at = plant::operating_point(grid.plants[1], grid.flow.voltage[2], 100.0, grid.conventions);
  EXPECT_NEAR(at.x[7], std::sqrt(at.s.V), 1e-12);  // six states of the machine, x, then the root
  const Trajectory one = lanes_run(grid, 1), eight = lanes_run(grid, 8), four = lanes_run(grid, 4);
  // Packs have their own sincos, 2 ulp off; adaptive steps carry it on.
  EXPECT_LE(test::largest_difference(one, eight), 1e-10);
  EXPECT_LE(test::largest_difference(one, four), 1e-10);
  // The law has corners that no integrator locates; hence smaller steps than usual for this comparison.
  EXPECT_LE(test::largest_difference(lanes_run(grid, 8, 1e-8), reference_run(grid, 1e-10)), 1e-5);
  grid::Grid without = grid;
  without.plants[1].controls.erase(without.plants[1].controls.begin());
  EXPECT_GT(test::largest_difference(one, lanes_run(without, 1)), 1e-2);  // it does something
}

/// Every state's derivative and the output, off the operating point, for parameters p.
template <class T>
std::vector<T> outputs(const Effect& law, const std::vector<T>& p, const Signals<double>& at,
                       const Signals<double>& moved) {
  std::vector<T> c(static_cast<std::size_t>(law.coefficients), T(0.0)), x(law.states.size(), T(0.0)), dx = x;
  Signals<T> s, now;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    s.*kMembers<T>[i] = T(at.*kMembers<double>[i]);
    now.*kMembers<T>[i] = T(moved.*kMembers<double>[i]);
  }
  const auto& ops = law.get<T>();
  ops.prepare(p.data(), Conventions::psse(), c.data());
  EXPECT_EQ(ops.control.steady(law.law.get(), p.data(), c.data(), s, x.data()), "");
  ops.control.evaluate(law.law.get(), c.data(), x.data(), now, dx.data());
  dx.push_back(now.*
               kMembers<T>[static_cast<std::size_t>(static_cast<const Definition*>(law.law.get())->output)]);
  return dx;
}
Signals<double> disturbed() {
  Signals<double> s = test::ControlBench::rated();
  s.V = s.Vc = 0.93;
  s.speed = 0.004;
  s.P = 0.7;
  s.t = 1.3;
  return s;
}

TEST(LawFile, PacksEqualDouble) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0.8, 1.2);
  const Effect nonlinear = make_law(kNonlinear, "n"), transfer = make_law(kByTransferFunction, "t");
  for (const Effect* law : {&sexs_law(), &nonlinear, &transfer}) {
    std::vector<std::vector<double>> each;
    std::vector<P8> packed(law->parameters.size());
    for (int lane = 0; lane < 8; ++lane) {
      auto p = law->standard_parameters();
      for (double& v : p) v *= u(random);
      for (std::size_t i = 0; i < p.size(); ++i) packed[i].set(lane, p[i]);
      each.push_back(outputs<double>(*law, p, test::ControlBench::rated(), disturbed()));
    }
    const auto together = outputs<P8>(*law, packed, test::ControlBench::rated(), disturbed());
    for (int lane = 0; lane < 8; ++lane)
      for (std::size_t i = 0; i < together.size(); ++i) {
        const double alone = each[static_cast<std::size_t>(lane)][i];
        // a contracted multiply-add here and not there, times gains of up to 1e3
        EXPECT_NEAR(together[i][lane], alone, 1e-12 * (1.0 + std::abs(alone))) << law->name << " " << i;
      }
  }
}

TEST(LawFile, DualsEqualCentralDifferences) {
  const Effect nonlinear = make_law(kNonlinear, "n"), transfer = make_law(kByTransferFunction, "t");
  for (const Effect* law : {&sexs_law(), &nonlinear, &transfer}) {
    const auto p = law->standard_parameters();
    for (std::size_t j = 0; j < p.size(); ++j) {
      std::vector<D8> dual(p.begin(), p.end());
      dual[j].d[0] = 1.0;
      std::vector<D8P8> packed(p.begin(), p.end());
      packed[j].d[3] = P8(1.0);
      const auto exact = outputs<D8>(*law, dual, test::ControlBench::rated(), disturbed());
      const auto lanes = outputs<D8P8>(*law, packed, test::ControlBench::rated(), disturbed());
      const double h = 1e-6 * std::max(1e-2, std::abs(p[j]));
      auto up = p, down = p;
      up[j] += h;
      down[j] -= h;
      const auto a = outputs<double>(*law, up, test::ControlBench::rated(), disturbed()),
                 b = outputs<double>(*law, down, test::ControlBench::rated(), disturbed());
      for (std::size_t i = 0; i < exact.size(); ++i) {
        const double quotient = (a[i] - b[i]) / (2 * h);
        // the quotient's own rounding: 1e-16 of values up to 1e2 over h = 1e-8
        EXPECT_NEAR(exact[i].d[0], quotient, 1e-6 * (10.0 + std::abs(quotient)))
            << law->name << " output " << i << " by " << law->parameters[j].name;
        EXPECT_NEAR(lanes[i].d[3][5], exact[i].d[0], 1e-12 * (1.0 + std::abs(exact[i].d[0]))) << law->name;
      }
    }
  }
}

/// An integrator with nothing to limit rests at its limit, and leaves it without delay.
TEST(LawFile, AStateMayRestAtItsLimit) {
  library::EffectLibrary library;
  test::ControlBench bench(
      load_law(std::filesystem::path(SWINGBANK_SOURCE) / "configs/laws/limiter_field_current.toml", library));
  ASSERT_EQ(bench.refused, "");
  EXPECT_EQ(bench.out().Vlimiter, 0.0);
  EXPECT_EQ(bench.largest_derivative(), 0.0);
  bench.run(5.0);
  bench.in.Ifd = 4.0;  // 1 pu above: 0.1 per second
  bench.run(2.0);
  EXPECT_NEAR(bench.out().Vlimiter, -0.2, 1e-12);
  bench.run(10.0);
  EXPECT_EQ(bench.out().Vlimiter, -0.5);
}

TEST(LawFile, TheExamplesAreSound) {
  int count = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(SWINGBANK_SOURCE) + "/configs/laws")) {
    if (file.path().extension() != ".toml") continue;
    library::EffectLibrary library;
    const Effect& law = load_law(file.path(), library);
    Problems problems;
    law.check(law.law.get(), law.standard_parameters().data(), file.path().string(), problems);
    EXPECT_TRUE(problems.empty()) << file.path();
    EXPECT_FALSE(law.description.empty());
    // A plant with it stands still and runs through a fault.
    grid::Grid grid = with_exciter(*library::compiled().find("SEXS"), {0.5, 2.0, 20.0, 0.05, -10.0, 10.0});
    auto& controls = grid.plants[1].controls;
    if (law.slot == Slot::exciter) controls.clear();
    controls.push_back({&law, law.standard_parameters()});
    std::ranges::stable_sort(controls, {}, [](const plant::Block& b) { return b.effect->slot; });
    const Trajectory run = lanes_run(grid, 8);
    EXPECT_EQ(run.outcome, Outcome::stable) << file.path();
    EXPECT_LE(test::largest_difference(run, reference_run(grid)), 1e-4)
        << file.path();  // the kernel's promise
    ++count;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace swingbank::sim::laws
