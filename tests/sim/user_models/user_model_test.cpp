// Results of user-defined models against compiled effects, in every scalar type.
#include <random>

#include "sim/library/library.hpp"
#include "sim/user_models/detail/definition.hpp"
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/user_models/on_a_grid.hpp"
#include "tests/sim/user_models/support.hpp"

namespace swingbank::sim::user_models {
namespace {

using test::kNonlinear;
using test::reference_run;
using test::sexs_user_model;
using test::with_exciter;

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
TAoverTB = { unit = "-", default = 0.1, low = 0.0, high = 10.0, meaning = "lead over lag" }
TB = { unit = "s", default = 10.0, low = 0.001, high = 100.0, meaning = "lag" }
K = { unit = "pu", default = 100.0, low = 0.5, high = 2000.0, meaning = "gain" }
TE = { unit = "s", default = 0.1, low = 0.001, high = 5.0, meaning = "exciter" }
EMIN = { unit = "pu", default = -4.0, low = -100.0, high = 0.0, meaning = "lower" }
EMAX = { unit = "pu", default = 5.0, low = 0.5, high = 100.0, meaning = "upper" }
)law";
/// The same exciter as a transfer function with a clamp behind it (which winds up).
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
TAoverTB = { unit = "-", default = 0.1, low = 0.0, high = 10.0, meaning = "lead over lag" }
TB = { unit = "s", default = 10.0, low = 0.001, high = 100.0, meaning = "lag" }
K = { unit = "pu", default = 100.0, low = 0.5, high = 2000.0, meaning = "gain" }
TE = { unit = "s", default = 0.1, low = 0.001, high = 5.0, meaning = "exciter" }
)law";

TEST(UserModelFile, ThreeWaysOfWritingAnExciterAgree) {
  const std::vector<double> p = {0.5, 2.0, 20.0, 0.05, -10.0, 10.0};
  const reference::ReferenceRun compiled = reference_run(with_exciter(*library::compiled().find("SEXS"), p));
  const Effect by_expressions = make_user_model(kByExpressions, "e"),
               by_transfer_function = make_user_model(kByTransferFunction, "t");
  // Other unknowns and other rounding: the difference of two runs at rtol 1e-8.
  EXPECT_LE(test::largest_difference(compiled, reference_run(with_exciter(by_expressions, p))), 1e-6);
  const grid::Grid tf = with_exciter(by_transfer_function, {0.5, 2.0, 20.0, 0.05});
  EXPECT_LE(test::largest_difference(compiled, reference_run(tf)), 1e-6);
}

TEST(UserModelFile, LimitedStatesDoNotWindUp) {
  test::ControlBench bench(sexs_user_model(),
                           {{"TAoverTB", 1.0}, {"K", 10.0}, {"TE", 0.5}, {"EMAX", 3.0}, {"EMIN", 0.0}});
  ASSERT_EQ(bench.refused, "");
  EXPECT_LE(bench.largest_derivative(),
            1e-13);      // rounding of K y = 2 over TE: some 10 ulp, with or without FMA
  bench.in.dVref = 1.0;  // demands Efd = 12
  bench.run(10.0);
  EXPECT_EQ(bench.out().Efd, 3.0);
  bench.in.dVref = 0.0;  // back to 2: it leaves the ceiling at once, e-folding 0.5 s
  bench.run(0.5);
  EXPECT_NEAR(bench.out().Efd, 2.0 + std::exp(-1.0), 1e-9);  // Runge-Kutta at TE / 500
}

/// Derivatives of all states, and the output, away from the operating point, for parameters p.
template <class T>
std::vector<T> outputs(const Effect& user_model, const std::vector<T>& p, const Signals<double>& at,
                       const Signals<double>& moved) {
  std::vector<T> c(static_cast<std::size_t>(user_model.coefficients), T(0.0)),
      x(user_model.states.size(), T(0.0)), dx = x;
  Signals<T> s, now;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    s.*kMembers<T>[i] = T(at.*kMembers<double>[i]);
    now.*kMembers<T>[i] = T(moved.*kMembers<double>[i]);
  }
  const auto& ops = user_model.get<T>();
  ops.prepare(p.data(), Conventions::psse(), c.data());
  EXPECT_EQ(ops.control.steady(user_model.user_model.get(), p.data(), c.data(), s, x.data()), "");
  ops.control.evaluate(user_model.user_model.get(), c.data(), x.data(), now, dx.data());
  dx.push_back(now.*kMembers<T>[static_cast<std::size_t>(
                        static_cast<const Definition*>(user_model.user_model.get())->output)]);
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

TEST(UserModelFile, PacksEqualDouble) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0.8, 1.2);
  const Effect nonlinear = make_user_model(kNonlinear, "n"),
               transfer = make_user_model(kByTransferFunction, "t");
  for (const Effect* user_model : {&sexs_user_model(), &nonlinear, &transfer}) {
    std::vector<std::vector<double>> each;
    std::vector<P8> packed(user_model->parameters.size());
    for (int lane = 0; lane < 8; ++lane) {
      auto p = user_model->default_parameters();
      for (double& v : p) v *= u(random);
      for (std::size_t i = 0; i < p.size(); ++i) packed[i].set(lane, p[i]);
      each.push_back(outputs<double>(*user_model, p, test::ControlBench::rated(), disturbed()));
    }
    const auto together = outputs<P8>(*user_model, packed, test::ControlBench::rated(), disturbed());
    for (int lane = 0; lane < 8; ++lane)
      for (std::size_t i = 0; i < together.size(); ++i) {
        const double alone = each[static_cast<std::size_t>(lane)][i];
        // fused multiply-add in one of the two only, times gains of up to 1e3
        EXPECT_NEAR(together[i][lane], alone, 1e-12 * (1.0 + std::abs(alone)))
            << user_model->name << " " << i;
      }
  }
}

TEST(UserModelFile, DualsEqualCentralDifferences) {
  const Effect nonlinear = make_user_model(kNonlinear, "n"),
               transfer = make_user_model(kByTransferFunction, "t");
  for (const Effect* user_model : {&sexs_user_model(), &nonlinear, &transfer}) {
    const auto p = user_model->default_parameters();
    for (std::size_t j = 0; j < p.size(); ++j) {
      std::vector<D8> dual(p.begin(), p.end());
      dual[j].d.set(0, 1.0);
      const auto exact = outputs<D8>(*user_model, dual, test::ControlBench::rated(), disturbed());
      const double h = 1e-6 * std::max(1e-2, std::abs(p[j]));
      auto up = p, down = p;
      up[j] += h;
      down[j] -= h;
      const auto a = outputs<double>(*user_model, up, test::ControlBench::rated(), disturbed()),
                 b = outputs<double>(*user_model, down, test::ControlBench::rated(), disturbed());
      for (std::size_t i = 0; i < exact.size(); ++i) {
        const double quotient = (a[i] - b[i]) / (2 * h);
        // rounding of the quotient: 1e-16 of values up to 1e2, divided by h = 1e-8
        EXPECT_NEAR(exact[i].d[0], quotient, 1e-6 * (10.0 + std::abs(quotient)))
            << user_model->name << " output " << i << " by " << user_model->parameters[j].name;
      }
    }
  }
}

/// A saturated integrator starts at its limit and leaves it without delay.
TEST(UserModelFile, AllowsAnOperatingPointAtALimit) {
  library::EffectLibrary library;
  test::ControlBench bench(load_user_model(
      std::filesystem::path(SWINGBANK_SOURCE) / "configs/user_models/limiter_field_current.toml", library));
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

TEST(UserModelFile, ExamplesPassTheChecks) {
  int count = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(SWINGBANK_SOURCE) + "/configs/user_models")) {
    if (file.path().extension() != ".toml") continue;
    library::EffectLibrary library;
    const Effect& user_model = load_user_model(file.path(), library);
    Problems problems;
    user_model.check(user_model.user_model.get(), user_model.default_parameters().data(),
                     file.path().string(), problems);
    EXPECT_TRUE(problems.empty()) << file.path();
    EXPECT_FALSE(user_model.description.empty());
    ++count;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace swingbank::sim::user_models
