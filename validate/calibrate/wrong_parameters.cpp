#include "validate/calibrate/wrong_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::calibrate {

WrongParameters wrong_parameters(const plant::PlantModel& model, std::vector<record::Record> records,
                                 const CalibrateOptions& options) {
  const auto free = chosen_parameters(model.plant, options.prior_sd, options.fixed);
  const auto events = noise::whitened_events(model, seen_records(records, options.held_out), options.events);
  fit::SparseOptions o;
  o.progress = options.progress;
  WrongParameters w;
  w.found = fit::select_parameters(model.under_test(), events, free, o);
  w.model = model;
  w.model.plant = w.found.fit.plant;
  w.adequate = options.adequate;
  w.sentence = wrong_sentence(w.found, w.adequate);
  return w;
}

namespace {
/// Returns " KPR and KIR together explain the records as well as KPM." for each alternative.
std::string alternatives_text(const fit::SparseSelection& found) {
  std::string text;
  for (const auto& a : found.alternatives)
    text += fmt::format(" {} together explain the records as well as {}.", fmt::join(a.instead, " and "),
                        fmt::join(a.named, " and "));
  return text;
}
}  // namespace

std::string wrong_sentence(const fit::SparseSelection& found, double adequate) {
  const std::string left = fmt::format(
      "reduced chi-square {:.3f} as submitted, {:.3f} with all parameters free", found.before, found.best);
  if (found.wrong.empty())
    return fmt::format("No parameter has to change: none explains more than noise ({}).", left);
  std::string names;
  for (const auto& w : found.wrong) {
    const std::string tied = fmt::format("{}", fmt::join(w.tied, ", "));
    names +=
        fmt::format("{}{} {:.4g} -> {:.4g} {}{}", names.empty() ? "" : "; ", w.fit.full_name(), w.fit.start,
                    w.fit.value, w.fit.unit, tied.empty() ? "" : " (or " + tied + ": not distinguishable)");
  }
  const bool one = found.wrong.size() == 1;
  const bool enough = found.fit.reduced_chi2() <= adequate;
  return fmt::format("{} {} must change{}: {}. The reduced chi-square is {:.3f} with {} changed ({}).{}",
                     enough ? "Only" : "At least",
                     one ? "one parameter" : fmt::format("{} parameters", found.wrong.size()),
                     enough ? "" : ", and the residual still exceeds noise", names, found.fit.reduced_chi2(),
                     one ? "it" : "them", left, alternatives_text(found));
}

std::string wrong_text(const WrongParameters& w) {
  std::string text = w.sentence + "\n";
  if (w.found.wrong.empty()) return text;
  text += fmt::format("\n{:<16} {:>12} {:>12} {:>26} {:>6} {:>12} {:>10}  {}\n", "parameter", "model",
                      "fitted", "95 % interval", "unit", "evidence", "share", "alternative");
  for (const auto& p : w.found.wrong) {
    text +=
        fmt::format("{:<16} {:>12.5g} {:>12.5g} {:>26} {:>6} {:>12.1f} {:>8.1f} %  {}\n", p.fit.full_name(),
                    p.fit.start, p.fit.value, fmt::format("{:.4g} to {:.4g}", p.fit.low, p.fit.high),
                    p.fit.unit, p.evidence, 100 * p.share, fmt::format("{}", fmt::join(p.tied, ", ")));
  }
  text +=
      "\nEvidence [chi2]: increase of the cost if this parameter keeps its value and the "
      "others are refitted. Share: this increase, relative to the increase if "
      "all parameters keep their values; shares need not add up to 100 %.\n";
  return text;
}

nlohmann::json wrong_json(const WrongParameters& w) {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& p : w.found.wrong)
    all.push_back({{"name", p.fit.full_name()},
                   {"unit", p.fit.unit},
                   {"model", p.fit.start},
                   {"fitted", p.fit.value},
                   {"low", p.fit.low},
                   {"high", p.fit.high},
                   {"evidence_chi2", p.evidence},
                   {"share_of_error", p.share},
                   {"or", p.tied}});
  nlohmann::json alternatives = nlohmann::json::array();
  for (const auto& a : w.found.alternatives)
    alternatives.push_back({{"named", a.named}, {"instead", a.instead}});
  return {{"sentence", w.sentence},
          {"wrong", all},
          {"alternatives", alternatives},
          {"chi2_per_value",
           {{"model", w.found.before},
            {"these_changed", w.found.fit.reduced_chi2()},
            {"all_free", w.found.best}}},
          {"statistically_complete", w.is_adequate()}};
}

}  // namespace swingbank::validate::calibrate
