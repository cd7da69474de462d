#include "validate/add/detail/joint_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <cctype>
#include <list>

#include "base/stop_signal.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::add {
namespace {

std::string plain(const std::string& name) {
  std::string out;
  for (const char c : name)
    if (c != ' ' && c != '\t') out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

std::optional<hypothesis::Hypothesis> named_hypothesis(const sim::plant::PlantUnderTest& tested,
                                                       const sim::library::EffectLibrary& library,
                                                       const hypothesis::RecordContents& recorded,
                                                       const std::string& name) {
  auto all = hypothesis::all_hypotheses(tested, library, recorded);
  std::ranges::move(hypothesis::all_replacements(tested, library), std::back_inserter(all));
  const auto found = std::ranges::find_if(
      all, [&](const hypothesis::Hypothesis& h) { return plain(h.name) == plain(name); });
  if (found == all.end()) return std::nullopt;
  return *found;
}

JointFit::JointFit(const plant::PlantModel& model, const std::vector<std::string>& names,
                   const hypothesis::RecordContents& recorded, Bench& bench, const AddOptions& options,
                   Addition& a)
    : names_(names),
      recorded_(recorded),
      bench_(bench),
      options_(options),
      a_(a),
      base_model_{.events = bench.seen(),
                  .plant = model.plant,
                  .conventions = model.conventions,
                  .library = model.library,
                  .fit = a.without,
                  .prior_sd = options.calibrate.prior_sd,
                  .threads = omp_get_max_threads(),
                  .stop = interruption_asked,
                  .reached = [this](const fit::Fit& f) { keep(f); }} {}

bool JointFit::run() {
  search();
  a_.without = from_other(hypothesis::unchanged(base_model_.under_test()), a_.without, a_.with);
  leave_out();
  bool measured = measure_noise();
  while (add_null_group()) measured |= measure_noise();
  for (AddedEffect& e : a_.effects) e.evidence = fit::gain(a_.without, a_.with, fit::criterion);
  for (const LeftOut& l : left_out_)
    a_.effects[l.effect].evidence = fit::gain(l.fit, a_.with, fit::criterion);
  return measured;
}

/// Adds the effects one after the other, each time the remaining effect with the most evidence. The
/// parameters of the effects added before stay free. The order of the names has no influence.
void JointFit::search() {
  std::list<hypothesis::Judgement> added;
  std::list<hypothesis::BaseModel> bases = {base_model_};
  for (auto left = names_; !left.empty();) {
    auto all = addable(bases.back().under_test(), left);
    if (all.empty())
      throw InputError({fmt::format("effects {}", fmt::join(left, ", ")), "swingbank add",
                        "they cannot be added together with the other effects", "add fewer effects"});
    added.push_back(best(bases.back(), std::move(all)));
    std::erase(left, added.back().hypothesis.name);
    bases.push_back(hypothesis::after(bases.back(), added.back()));
  }
  a_.hypothesis = added.back().hypothesis;
  a_.with = finished(added.back());
  for (const std::string& name : names_) {
    const auto j =
        std::ranges::find(added, name, [](const hypothesis::Judgement& one) { return one.hypothesis.name; });
    a_.effects.push_back({name, j->hypothesis.what, 0});
    a_.hypothesis.added |= j->hypothesis.added;
  }
}

/// If there are several effects, refits the structure without each effect, and searches for this effect again
/// with the others in place. The effects added first had also been fitted to the response that later effects
/// explain.
void JointFit::leave_out() {
  if (names_.size() < 2) return;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    std::vector<std::string> others = names_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    hypothesis::Judgement without;
    without.hypothesis = together(std::move(others));
    without.fit = hypothesis::fit_from(base_model_, without.hypothesis, a_.with, without.hypothesis.plant);
    if (!without.fit.failed.empty())
      throw InputError({"the model without " + names_[i] + " cannot be fitted", "swingbank add",
                        without.fit.failed, "add the other effects without " + names_[i]});
    a_.with = from_other(a_.hypothesis, a_.with, without.fit);
    const hypothesis::BaseModel base = hypothesis::after(base_model_, without);
    for (const hypothesis::Judgement& j : judgements(base, addable(base.under_test(), {names_[i]})))
      if (j.fitted && j.hypothesis.free.size() == a_.hypothesis.free.size())
        a_.with = from_other(a_.hypothesis, a_.with, j.fit);
    left_out_.push_back({i, std::move(without.hypothesis), std::move(without.fit)});
  }
  for (LeftOut& l : left_out_) l.fit = from_other(l.others, l.fit, a_.with);
}

/// If the reduced chi-square of the fit with the effects is low enough, estimates the noise again from its
/// residuals and repeats all fits.
bool JointFit::measure_noise() {
  if (!bench_.measure_noise(a_.with, a_.hypothesis.conventions)) return false;
  a_.without = bench_.go_on(hypothesis::unchanged(base_model_.under_test()), a_.without);
  a_.with = bench_.go_on(a_.hypothesis, a_.with);
  for (LeftOut& l : left_out_) l.fit = bench_.go_on(l.others, l.fit);
  return true;
}

/// If a single effect is added, frees one group of its parameters that are at null values by default: the
/// group with the most evidence. Returns false if no group has the evidence that an effect needs.
bool JointFit::add_null_group() {
  if (names_.size() > 1) return false;
  auto groups = hypothesis::with_left_off(a_.hypothesis, a_.with.plant);
  if (groups.empty()) return false;
  const auto tried = judgements(base_model_, std::move(groups));
  if (tried.empty() || !tried.front().fitted) return false;
  fit::Fit with = finished(tried.front());
  a_.with = from_other(a_.hypothesis, a_.with, with);
  with = from_other(tried.front().hypothesis, with, a_.with);
  if (!(fit::gain(a_.with, with, fit::criterion) > thresholds::addition.strong)) return false;
  a_.with = std::move(with);
  const std::string name = a_.hypothesis.name;
  a_.hypothesis = tried.front().hypothesis;
  a_.hypothesis.name = name;
  return true;
}

/// Returns the fitted hypothesis with the most evidence.
hypothesis::Judgement JointFit::best(const hypothesis::BaseModel& base,
                                     std::vector<hypothesis::Hypothesis> all) {
  hypothesis::Judgement j;
  j.hypothesis = all.front();
  j.fitted = false;
  if (auto tried = judgements(base, std::move(all)); !tried.empty())
    j = std::move(tried.front());
  else
    hypothesis::bring(base, j.hypothesis);
  if (!j.fitted) until_interrupted([&] { hypothesis::fit_alone(base, j); });
  if (interruption_asked()) end();
  if (!j.fit.failed.empty())
    throw InputError({"effect " + j.hypothesis.name + " cannot be fitted from any start", "swingbank add",
                      j.fit.failed, "check the model's parameters, or add another effect"});
  return j;
}

/// Returns the hypotheses in descending order of evidence.
std::vector<hypothesis::Judgement> JointFit::judgements(const hypothesis::BaseModel& base,
                                                        std::vector<hypothesis::Hypothesis> all) {
  std::vector<hypothesis::Judgement> tried;
  until_interrupted(
      [&] { tried = hypothesis::try_hypotheses(base, std::move(all), options_.calibrate.progress); });
  if (interruption_asked()) end();
  return tried;
}

/// Returns the hypotheses of those names that can be added to the plant as it is.
std::vector<hypothesis::Hypothesis> JointFit::addable(const sim::plant::PlantUnderTest& tested,
                                                      const std::vector<std::string>& names) const {
  std::vector<hypothesis::Hypothesis> all;
  for (const std::string& name : names)
    if (auto h = named_hypothesis(tested, base_model_.library, recorded_, name)) all.push_back(std::move(*h));
  return all;
}

/// Returns the hypothesis with all of these effects at their start values. Effects that act only through an
/// absent effect are left out.
hypothesis::Hypothesis JointFit::together(std::vector<std::string> names) const {
  hypothesis::Judgement all;
  all.hypothesis = hypothesis::unchanged(base_model_.under_test());
  for (auto next = addable(all.hypothesis.under_test(), names); !next.empty();
       next = addable(all.hypothesis.under_test(), names)) {
    all.fit.plant = all.hypothesis.plant;
    hypothesis::bring(hypothesis::after(base_model_, all), next.front());
    all.hypothesis = std::move(next.front());
    std::erase(names, all.hypothesis.name);
  }
  return all.hypothesis;
}

/// Returns the better of the fit `f` of `h` and a refit of `h` from the end of another structure's fit. The
/// difference between two local optima of one structure then does not count as evidence.
fit::Fit JointFit::from_other(const hypothesis::Hypothesis& h, const fit::Fit& f,
                              const fit::Fit& other) const {
  hypothesis::Judgement j;
  j.hypothesis = h;
  j.fit = f;
  hypothesis::try_from(base_model_, other, j);
  return fit::better(j.fit, f) ? finished(j) : f;
}

/// Returns the fit completed with standard errors. Fits of the search have none, or those of an integration
/// with relaxed tolerance.
fit::Fit JointFit::finished(const hypothesis::Judgement& j) const {
  fit::Fit f = bench_.go_on(j.hypothesis, j.fit);
  return f.failed.empty() ? f : j.fit;
}

void JointFit::keep(const fit::Fit& f) {
  const std::lock_guard guard(lock_);
  if (reached_ && !(fit::penalised(f) < fit::penalised(*reached_))) return;
  reached_ = f;
  if (options_.reached) options_.reached(f);
}

void JointFit::end() {
  if (a_.with.parameters.empty() && reached_) a_.with = *reached_;
  throw Interrupted{};
}

}  // namespace swingbank::validate::add
