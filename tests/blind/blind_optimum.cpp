// blind-optimum: the difference in chi2 between the fit of the true structure by the diagnosis and a fit that
// starts at the truth. Input: cases of `swingbank blind-test` with no or one hidden effect. Output, one line
// per case: case, hidden effect, decrease of chi2 by the start at the truth, reduced chi2 of that fit and of
// the diagnosis' fit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "research/blind/cases/plan.hpp"
#include "research/blind/score/judge.hpp"
#include "validate/calibrate/side_by_side.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::research;
using namespace swingbank::validate;
namespace fs = std::filesystem;

/// Maximum number of calls of the optimiser for a fit from the truth; each continues the call before.
constexpr int kTruthRounds = 5;

/// The true structure as fitted by the diagnosis.
struct Ended {
  sim::plant::PlantUnderTest tested;
  std::vector<fit::FreeParameter> free;
  const fit::Fit* fit;
};
/// Returns the diagnosis' fit of the true structure; nullopt if the diagnosis did not fit it.
std::optional<Ended> true_one(const plant::PlantModel& model, const diagnose::Diagnosis& d,
                              const nlohmann::json& hidden, double prior_sd) {
  if (hidden.empty()) return Ended{model.under_test(), fit::free_parameters(model.plant, prior_sd), &d.base};
  const auto accepted_names = hidden.front().at("answers").get<std::vector<std::string>>();
  for (const hypothesis::Judgement& j : d.ranked)
    if (j.fitted && j.fit.failed.empty() &&
        std::ranges::count(accepted_names, hypothesis::full_name(j.hypothesis)))
      return Ended{j.hypothesis.under_test(), hypothesis::free_of(j.hypothesis, prior_sd), &j.fit};
  return std::nullopt;
}

/// Returns the better of two fits that start at the true parameter values: one continues the event states of
/// `ended`, the other starts with the initial event states.
fit::Fit from_truth(const Ended& ended, const noise::WhitenedEvents& events, const calibrate::Truth& truth) {
  std::vector<double> values = fit::values_of(ended.fit->plant, ended.free);
  for (std::size_t i = 0; i < ended.free.size(); ++i)
    if (const auto at = truth.find(sim::plant::parameter_name(ended.fit->plant, ended.free[i].id).text());
        at != truth.end())
      values[i] = at->second;
  const auto arrive = [&](fit::FitOptions o) {
    o.values = values;
    fit::Fit f = fit::fit(ended.tested, events, ended.free, o);
    for (int round = 1; round < kTruthRounds && f.failed.empty() && !f.converged; ++round)
      f = fit::fit(ended.tested, events, ended.free,
                   fit::continued({.lenient = true, .errors = false}, f, ended.free));
    return f;
  };
  const fit::FitOptions fresh{.lenient = true, .errors = false};
  return std::min(arrive(fit::continued(fresh, *ended.fit, ended.free)), arrive(fresh), fit::better);
}

void print_optimum(const fs::path& run, const std::string& name, const diagnose::DiagnoseOptions& options) {
  const fs::path file = run / "truth" / (name + ".json");
  const auto hidden = nlohmann::json::parse(read_text(file)).at("hidden");
  if (hidden.size() > 1 || (!hidden.empty() && !hidden.front().at("listed").get<bool>())) return;
  const std::string what = hidden.empty()
                               ? "nothing"
                               : fmt::format("{} ({:.0f})", hidden.front().at("kind").get<std::string>(),
                                             hidden.front().at("left_noise").get<double>());
  const blind::score::SeenCase seen = blind::score::read_seen_case(run / "cases" / name);
  const diagnose::Diagnosis d = diagnose::diagnose(seen.model, seen.records, options);
  const auto ended = true_one(seen.model, d, hidden, options.prior_sd);
  if (!ended) {
    fmt::print("{} {}: not fitted\n", name, what);
  } else {
    const fit::Fit best = from_truth(*ended, d.events, calibrate::read_truth(file, seen.model));
    fmt::print("{} {}: {:.1f}, {:.4f} of {:.4f}{}\n", name, what, fit::gain(*ended->fit, best),
               best.reduced_chi2(), ended->fit->reduced_chi2(), best.converged ? "" : ", not converged");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("compares the diagnosis' fit of the true structure with a fit that starts at the true values");
  fs::path run;
  std::string part = "1/1";
  app.add_option("--run", run, "folder that blind-test --make wrote")->required();
  app.add_option("--part", part, "K/N: every N-th case, from the K-th");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto [k, n] = blind::cases::read_part(part);
    diagnose::DiagnoseOptions options;
    options.threads = 1;
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator(run / "truth"))
      names.push_back(file.path().stem().string());
    std::ranges::sort(names);
    for (auto i = static_cast<std::size_t>(k - 1); i < names.size(); i += static_cast<std::size_t>(n))
      print_optimum(run, names[i], options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
