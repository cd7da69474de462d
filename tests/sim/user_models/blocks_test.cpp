// Blocks of user-defined models, and their operating points.
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/reference/reference_support.hpp"
#include "tests/sim/user_models/support.hpp"

namespace swingbank::sim::user_models {
namespace {

using test::kHead;
using test::sexs_user_model;
using test::user_model_of;

std::complex<double> of_block(const std::string& block, double omega, const std::string& more = "") {
  const Effect user_model = make_user_model(
      fmt::format("name = \"B\"\n{}output = \"Vs\"\naction = \"replace\"\ninput = \"speed\"\nchain = "
                  "[\"b\"]\n{}\n[blocks.b]\n{}\n",
                  kHead, more, block),
      "block.toml");
  test::ControlBench bench(user_model);
  EXPECT_EQ(bench.refused, "") << block;
  if (!bench.x.empty()) return bench.response(&Signals<double>::speed, &Signals<double>::Vs, omega);
  const double before = bench.out().Vs;
  bench.in.speed += 1e-3;
  return (bench.out().Vs - before) / 1e-3;
}

TEST(UserModelBlocks, HaveTheirTransferFunctions) {
  const double w = 3.0;
  const std::complex<double> s(0.0, w);
  const auto same = [&](const std::string& block, std::complex<double> expected) {
    EXPECT_NEAR(std::abs(of_block(block, w) - expected), 0.0, 1e-8)
        << block;  // difference quotients with a step of 1e-6
  };
  same("kind = \"gain\"\nK = 3", 3.0);
  same("kind = \"lag\"\nT = 0.4", 1.0 / (1.0 + 0.4 * s));
  same("kind = \"lag\"\nK = \"2*5\"\nT = 0.4", 10.0 / (1.0 + 0.4 * s));
  same("kind = \"lag\"\nK = 10\nT = 0", 10.0);
  same("kind = \"lead_lag\"\nTa = 2\nTb = 0.4\nK = 3", 3.0 * (1.0 + 2.0 * s) / (1.0 + 0.4 * s));
  same("kind = \"lead_lag\"\nTa = 2\nTb = 0", 1.0);
  same("kind = \"washout\"\nT = 2", 2.0 * s / (1.0 + 2.0 * s));
  same("kind = \"washout\"\nT = 0", 0.0);
  same("kind = \"integrator\"\nK = 4", 4.0 / s);
  same("kind = \"transfer_function\"\nnumerator = [\"1\", \"2\"]\ndenominator = [\"1\", \"3\", \"4\"]",
       (1.0 + 2.0 * s) / (1.0 + 3.0 * s + 4.0 * s * s));
  same(
      "kind = \"transfer_function\"\nnumerator = [\"1\", \"0.5\", \"0.25\"]\ndenominator = [\"2\", \"3\", "
      "\"4\"]",
      (1.0 + 0.5 * s + 0.25 * s * s) / (2.0 + 3.0 * s + 4.0 * s * s));
  same("kind = \"deadband\"\nwidth = 0", 1.0);
}

/// A lag in the forward path closes a loop: K/(1 + sT) with feedback of its own washout.
TEST(UserModelBlocks, FeedbackThroughALag) {
  const std::string text = fmt::format(R"law(name = "FEEDBACK"
{}output = "Vs"
action = "replace"
value = "forward"
[blocks.forward]
kind = "lag"
input = "speed - back"
K = 10
T = "T"
[blocks.back]
kind = "washout"
input = "forward"
K = 0.2
T = 1.5
[parameters]
T = {{ unit = "s", default = 0.5, low = 0.01, high = 5, meaning = "lag" }}
)law",
                                       kHead);
  const Effect user_model = make_user_model(text, "feedback.toml");
  test::ControlBench bench(user_model);
  ASSERT_EQ(bench.refused, "");
  const std::complex<double> s(0.0, 2.0), forward = 10.0 / (1.0 + 0.5 * s),
                                          back = 0.2 * 1.5 * s / (1.0 + 1.5 * s);
  EXPECT_NEAR(std::abs(bench.response(&Signals<double>::speed, &Signals<double>::Vs, 2.0) -
                       forward / (1.0 + forward * back)),
              0.0, 1e-8);
}

std::string refusal(const std::string& text, Signals<double> s = test::ControlBench::rated()) {
  const Effect user_model = make_user_model(text, "x.toml");
  const auto p = user_model.default_parameters();
  std::vector<double> c(static_cast<std::size_t>(user_model.coefficients)), x(user_model.states.size());
  user_model.get<double>().prepare(p.data(), Conventions::psse(), c.data());
  return user_model.get<double>().control.steady(user_model.user_model.get(), p.data(), c.data(), s,
                                                 x.data());
}
TEST(UserModelOperatingPoint, RefusesInfeasibleOperatingPointWithReason) {
  EXPECT_EQ(refusal(user_model_of("Efd", "replace", "value = \"3.5\"")),
            "it gives Efd = 3.5 pu, but the machine needs 2 pu; declare a reference = \"solve\"");
  EXPECT_EQ(refusal(user_model_of("Tm", "add", "value = \"0.1 * V\"")),
            "it adds 0.1 pu to Tm in the steady state (subtract "
            "the value at the operating point, as in V - V0)");
  EXPECT_EQ(refusal(user_model_of("Tm", "add", "value = \"0.1 * (V - V0)\"")), "");
  EXPECT_EQ(
      refusal(user_model_of("Vs", "add",
                            "value = \"x\"\n[states.x]\nunit = \"pu\"\nmeaning = \"m\"\nderivative = \"1\"")),
      "state x has no steady state: it changes by 1 per second at 0 pu");
  EXPECT_EQ(
      refusal(user_model_of(
          "Vs", "add", "value = \"x\"\n[states.x]\nunit = \"pu\"\nmeaning = \"m\"\nderivative = \"log(x)\"")),
      "the derivative of x is not a finite number at the operating point");
  EXPECT_EQ(refusal(user_model_of("Vs", "add", "value = \"1 / speed\"")),
            "its Vs is not a finite number at the operating point");
  // evaluated before the first switching time, independent of the later value
  EXPECT_EQ(
      refusal(user_model_of("Tm", "add", "value = \"select(t < 1, 0, 0.1)\"\nswitching_times = [\"1\"]")),
      "");
}

TEST(UserModelOperatingPoint, NamesTheViolatedLimitAndItsValue) {
  grid::Grid grid = test::two_machine_grid(Conventions::psse());
  grid.plants[1].controls = {{&sexs_user_model(), {0.1, 10.0, 100.0, 0.1, -4.0, 0.9}}};
  try {
    (void)plant::operating_point(grid.plants[1], grid.flow.voltage[2], 100.0, grid.conventions);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("its upper limit is 0.9 pu"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("exciter of SEXSLAW = "), std::string::npos) << e.what();
  }
}

TEST(UserModelOperatingPoint, ParametersAreChecked) {
  const auto problems = [](std::vector<double> p) {
    Problems found;
    sexs_user_model().check(sexs_user_model().user_model.get(), p.data(), "here", found);
    return found.list();
  };
  EXPECT_TRUE(problems({0.1, 10.0, 100.0, 0.1, -4.0, 5.0}).empty());
  const auto crossed = problems({0.1, 10.0, 100.0, 0.1, 6.0, 5.0});
  ASSERT_EQ(crossed.size(), 1u);
  EXPECT_NE(crossed[0].sentence().find("EMIN < EMAX is violated: 6 and 5 at here"), std::string::npos)
      << crossed[0].sentence();
  EXPECT_EQ(problems({std::nan(""), 10.0, 100.0, 0.1, -4.0, 5.0}).size(), 1u);
  const Effect user_model = make_user_model(user_model_of("Vs", "add", R"law(value = "speed / T"
[parameters]
T = { unit = "s", default = 1, low = 0, high = 2, meaning = "divisor" })law"),
                                            "x.toml");
  const double zero = 0.0;
  Problems found;
  user_model.check(user_model.user_model.get(), &zero, "here", found);
  (void)found;  // speed / T divides by zero in the loop: refused at the operating point
  EXPECT_EQ(refusal(user_model_of("Vs", "add", R"law(value = "speed / T"
[parameters]
T = { unit = "s", default = 0, low = 0, high = 2, meaning = "divisor" })law")),
            "its Vs is not a finite number at the operating point");
}

}  // namespace
}  // namespace swingbank::sim::user_models
