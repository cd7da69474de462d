#include "validate/user_model_search/detail/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace swingbank::validate::user_model_search {
namespace {

/// Duration of every rise and fall [s]. An abrupt step would have a zero gradient with respect to its time.
constexpr double kRise = 0.05;
/// Absolute sine above which a square wave has its full amplitude. An abrupt edge would have a zero gradient.
constexpr double kEdge = 0.1;
/// Number of harmonics of a sawtooth; the omitted ones contain 4 % of its mean square.
constexpr int kHarmonics = 16;

double edge(double tau) { return std::clamp(tau / kRise, 0.0, 1.0); }
double sawtooth(double turns) { return 2 * (turns - std::floor(turns)) - 1; }
double square(double turns) { return std::clamp(std::sin(constants::turn * turns) / kEdge, -1.0, 1.0); }
/// Returns the sawtooth as a Fourier series, because TOML files have no remainder function; turn = pi f tau.
std::string sawtooth_series() {
  std::string text;
  for (int k = 1; k <= kHarmonics; ++k)
    text += fmt::format("{}sin({} * turn) / {}", k == 1 ? "" : " + ", 2 * k, k);
  return "-2 / pi * (" + text + ")";
}

std::vector<double> frequencies(double length) {
  std::vector<double> all;
  for (double f = 0.08; f <= 3.0; f += std::max(0.02, 0.25 / length)) all.push_back(f);
  return all;
}
UserModelParameter time(const std::string& name, const std::string& meaning) {
  return {name, "s", 0, 1e-3, 1000, false, meaning};
}
const std::string kBegins = fmt::format("clamp(tau / {:g}, 0, 1)", kRise);
const std::vector<double> kLengths = {0.2, 0.3, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8, 10};

void add_transients(std::vector<UserModelShape>& all) {
  all.push_back({.family = "step",
                 .time_series = [](double tau, double) { return edge(tau); },
                 .value = kBegins,
                 .words = "a step of {A} that begins {begin}"});
  all.push_back({.family = "pulse",
                 .time_series = [](double tau, double b) { return edge(tau) - edge(tau - b); },
                 .grid = kLengths,
                 .second = time("length", "duration"),
                 .value = fmt::format("({} - clamp((tau - length) / {:g}, 0, 1))", kBegins, kRise),
                 .words = "a pulse of {A} that begins {begin} and lasts {length}"});
  all.push_back({.family = "ramp",
                 .time_series = [](double tau, double b) { return std::clamp(tau / b, 0.0, 1.0); },
                 .grid = kLengths,
                 .second = time("length", "rise time"),
                 .value = "clamp(tau / length, 0, 1)",
                 .words = "a ramp to {A} that begins {begin} and takes {length}"});
  all.push_back(
      {.family = "decaying",
       .time_series = [](double tau, double b) { return edge(tau) * std::exp(-std::max(0.0, tau) / b); },
       .grid = kLengths,
       .second = time("T", "time constant of the decay"),
       .value = kBegins + " * exp(-max(tau, 0) / T)",
       .words = "a pulse of {A} that begins {begin} and decays with {T}"});
}
void add_oscillations(std::vector<UserModelShape>& all, const std::vector<double>& grid) {
  const UserModelParameter f{"f", "Hz", 0, 0.01, 30, false, "frequency"};
  all.push_back(
      {.kind = UserModelShape::Kind::sine,
       .family = "periodic",
       .time_series = [](double tau, double) { return edge(tau); },
       .grid = grid,
       .second = f,
       .value = kBegins + " * sin(2 * pi * f * turned + phase)",
       .words = "an oscillation of amplitude {A} at {f} that begins {begin} (phase {phase} at {centre})"});
  all.push_back({.kind = UserModelShape::Kind::wave,
                 .family = "periodic, sawtooth",
                 .time_series = [](double tau, double b) { return edge(tau) * sawtooth(b * tau); },
                 .grid = grid,
                 .second = f,
                 .value = kBegins + " * wave",
                 .signals = "turn = \"pi * f * tau\"\nwave = \"" + sawtooth_series() + "\"\n",
                 .words = "a sawtooth of amplitude {A} at {f} that begins {begin}"});
  all.push_back({.kind = UserModelShape::Kind::wave,
                 .family = "periodic, square",
                 .time_series = [](double tau, double b) { return edge(tau) * square(b * tau); },
                 .grid = grid,
                 .second = f,
                 .value = kBegins + " * wave",
                 .signals = fmt::format("wave = \"clamp(sin(2 * pi * f * tau) / {:g}, -1, 1)\"\n", kEdge),
                 .words = "a square wave of amplitude {A} at {f} that begins {begin}"});
}

}  // namespace

std::vector<UserModelShape> user_model_shapes(double length) {
  std::vector<UserModelShape> all;
  add_transients(all);
  add_oscillations(all, frequencies(length));
  return all;
}

}  // namespace swingbank::validate::user_model_search
