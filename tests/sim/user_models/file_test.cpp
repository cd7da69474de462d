// Files of user-defined models: expressions and refusals.
#include "sim/library/library.hpp"
#include "tests/sim/effects/control_bench.hpp"
#include "tests/sim/user_models/support.hpp"

namespace swingbank::sim::user_models {
namespace {

using test::kHead;
using test::user_model_of;

/// User-defined model with one expression, added to Vs.
std::string one_value(const std::string& expression) {
  return fmt::format("name = \"ONE\"\n{}output = \"Vs\"\naction = \"add\"\nvalue = \"{}\"\n", kHead,
                     expression);
}
double value_of_expression(const std::string& expression) {
  const Effect user_model = make_user_model(one_value(expression), "one.toml");
  std::vector<double> c(static_cast<std::size_t>(user_model.coefficients));
  Signals<double> s = test::ControlBench::rated();
  s.speed = 0.01;
  user_model.get<double>().prepare(nullptr, Conventions::psse(50.0), c.data());
  Signals<double> rest = s;
  EXPECT_EQ(
      user_model.get<double>().control.steady(user_model.user_model.get(), nullptr, c.data(), rest, nullptr),
      "")
      << expression;
  user_model.get<double>().control.evaluate(user_model.user_model.get(), c.data(), nullptr, s, nullptr);
  return s.Vs;
}

TEST(UserModelExpression, ComputesAsWritten) {
  const std::vector<std::pair<const char*, double>> cases = {{"1 + 2 * 3", 7},
                                                             {"(1 + 2) * 3", 9},
                                                             {"2 - 3 - 4", -5},
                                                             {"8 / 4 / 2", 1},
                                                             {"-2 ^ 2", -4},
                                                             {"2 ^ 3 ^ 2", 64},
                                                             {"2 ^ 0", 1},
                                                             {"-3 * -2", 6},
                                                             {"+1.5e1", 15},
                                                             {"min(2, -1) + max(2, -1)", 1},
                                                             {"abs(-2.5) + abs(2)", 4.5},
                                                             {"sqrt(16) + exp(0) + log(1)", 5},
                                                             {"sin(0) + cos(0)", 1},
                                                             {"cos(2 * pi)", 1},
                                                             {"clamp(5, -1, 2) + clamp(-5, -1, 2)", 1},
                                                             {"deadband(0.5, 0.2)", 0.3},
                                                             {"deadband(-0.5, 0.2)", -0.3},
                                                             {"deadband(0.1, 0.2)", 0},
                                                             {"select(1 < 2, 10, 20)", 10},
                                                             {"select(1 > 2, 10, 20)", 20},
                                                             {"select(2 <= 2, 10, 20)", 10},
                                                             {"select(2 < 2, 10, 20)", 20},
                                                             {"select(2 >= 2, select(1 < 0, 1, 2), 20)", 2},
                                                             {"frequency", 50},
                                                             {"V + Efd0 * 2 + P0", 1 + 2.0 * 2 + 0.8},
                                                             {"speed * 100 - speed0 * 100", 0},
                                                             {"V*V - V^2", 0},
                                                             {"  1\\n + \\t 2 ", 3}};
  for (const auto& [expression, expected] : cases)
    EXPECT_NEAR(value_of_expression(expression), expected, 1e-13) << expression;  // rounding
}

TEST(UserModelExpression, ReportsEveryErrorWithItsPosition) {
  const auto message = [](const std::string& text) {
    try {
      (void)make_user_model(text, "x.toml");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  // `value = "` is the sixth line; the expression begins at its column 10.
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"1 +", "the expression ends too early in value at x.toml:6:13"},
      {"1 $ 2", "'$' after the end of the expression in value at x.toml:6:12"},
      {"(1", "a missing ')' in value at x.toml:6:12"},
      {"2x", "a name directly after a number in value at x.toml:6:11"},
      {"foo(1)", "unknown function foo in value at x.toml:6:10"},
      {"1 + bar", "unknown name bar in value at x.toml:6:14"},
      {"min(1)", "min with 1 arguments in value at x.toml:6:10"},
      {"sqrt", "function sqrt without arguments in value at x.toml:6:10"},
      {"select(1, 2, 3)", "a value as the condition of select in value at x.toml:6:17"},
      {"1 < 2", "a comparison where a value is needed in value at x.toml:6:12"},
      {"2 * (1 < 2)", "a comparison inside an expression in value at x.toml:6:17"},
      {"2 ^ 0.5", "an exponent that is no whole number from 0 to 16 in value at x.toml:6:14"},
      {"2 ^ 99", "an exponent that is no whole number from 0 to 16 in value at x.toml:6:14"},
      {"1e999", "an invalid number in value at x.toml:6:10"},
      {"", "the expression ends too early in value at x.toml:6:10"},
      {"Efd", "signal Efd in value at x.toml:6:10"},
      {"Vs", "signal Vs in value at x.toml:6:10"}};
  for (const auto& [expression, expected] : cases) {
    const std::string said = message(one_value(expression));
    EXPECT_NE(said.find(expected), std::string::npos) << expression << ": " << said;
  }
  const std::string deep(300, '(');
  EXPECT_NE(message(one_value(deep)).find("nested too deeply"), std::string::npos);
}

/// Complete user-defined model that contains every error.
TEST(UserModelFile, ReportsAllErrorsAtOnce) {
  const std::string text = std::string("name = \"a b\"\n") + kHead + R"law(
output = "Efd"
action = "replace"
value = "K * nothing + loop"
surplus = 1
require = ["K < speed", "K +"]
[parameters]
K = { unit = "pu", default = 5.0, low = 0.0, high = 1.0, meaning = "gain" }
speed = { unit = "pu", default = 0.5, low = 0.0, high = 1.0, meaning = "a signal's name" }
[signals]
loop = "loop + 1"
[states.x]
unit = "pu"
derivative = "Efd"
[references]
V1 = "V * 2"
)law";
  try {
    (void)make_user_model(text, "bad.toml");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string said = e.what();
    for (const char* part :
         {"'a b' in name at bad.toml:1:", "unknown name nothing in value at bad.toml:7:14",
          "unknown key surplus", "a requirement on more than parameters",
          "the expression ends too early in require[1] at bad.toml:9:", "parameters.K.default = 5.0",
          "parameter called speed",
          "a loop through loop in signals.loop at bad.toml:14:", "missing key states.x.meaning",
          "signal Efd in states.x.derivative at bad.toml:17:", "reference V1 varies during the run"})
      EXPECT_NE(said.find(part), std::string::npos) << part << "\nis not in\n" << said;
    for (const Problem& p : e.problems())
      EXPECT_FALSE(p.remedy.empty() || p.why.empty() || p.where.empty()) << p.what;
  }
}

TEST(UserModelFile, UnreadableFilesAreRefused) {
  library::EffectLibrary library;
  EXPECT_THROW(load_user_model("/nowhere.toml", library), InputError);
  EXPECT_THROW(make_user_model("not toml at all [", "x"), InputError);
  EXPECT_THROW(make_user_model("", "x"), InputError);
  EXPECT_THROW(make_user_model(std::string(200000, '#'), "x"), InputError);
}

TEST(UserModelFile, EqualTextsShareAnEffectAndNamesAreUnique) {
  library::EffectLibrary library;
  std::string text = one_value("speed");
  const Effect& first = load_user_model(text, "a.toml", library);
  EXPECT_EQ(&load_user_model(text, "a.toml", library), &first);
  EXPECT_EQ(library.find("one"), &first);
  EXPECT_THROW(load_user_model(text + "\n", "b.toml", library), InputError);
  text.replace(text.find("ONE"), 3, "SEXS");
  EXPECT_THROW(load_user_model(text, "c.toml", library), InputError);
}

TEST(UserModelFile, EqualTextsInTwoLibrariesAreOneEffect) {
  library::EffectLibrary one, other, changed;
  const Effect& user_model = load_user_model(one_value("speed"), "a.toml", one);
  EXPECT_TRUE(same_effect(user_model, load_user_model(one_value("speed"), "b.toml", other)));
  EXPECT_FALSE(same_effect(user_model, load_user_model(one_value("2 * speed"), "a.toml", changed)));
  EXPECT_FALSE(same_effect(user_model, *one.find("SEXS")));
  EXPECT_TRUE(same_effect(*one.find("SEXS"), *other.find("SEXS")));
}

TEST(UserModelFile, SourceOfAValueIsTheParametersOrTheFile) {
  const Effect user_model = make_user_model(user_model_of("Vs", "add", R"law(value = "a * b * 0"
[parameters]
a = { unit = "pu", default = 1, low = 0, high = 2, meaning = "said", source = "a plant's data sheet" }
b = { unit = "pu", default = 1, low = 0, high = 2, meaning = "not said" })law"),
                                            "plant.toml");
  EXPECT_EQ(as_text(user_model.parameters[0].default_from), "a plant's data sheet");
  EXPECT_EQ(as_text(user_model.parameters[0].bounds_from), "a plant's data sheet");
  EXPECT_EQ(as_text(user_model.parameters[1].default_from), "plant.toml");
}

TEST(UserModelFile, SwitchingTimesComeFromParameters) {
  const Effect user_model =
      make_user_model(user_model_of("Tm", "add", R"law(value = "select(t < start, 0, 0.1)"
switching_times = ["start", "start + 2"]
[parameters]
start = { unit = "s", default = 1, low = 0, high = 20, meaning = "when" })law"),
                      "x.toml");
  const double start = 3.0;
  ASSERT_NE(user_model.switching_times, nullptr);
  EXPECT_EQ(user_model.switching_times(user_model.user_model.get(), &start), (std::vector<double>{3.0, 5.0}));
}

}  // namespace
}  // namespace swingbank::sim::user_models
