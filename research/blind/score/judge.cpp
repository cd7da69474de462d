#include "research/blind/score/judge.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "validate/event/point.hpp"
#include "validate/noise/level.hpp"
#include "validate/noise/lines.hpp"

namespace swingbank::research::blind::score {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> event_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// Returns the evidence of all hypotheses, so that the probabilities can be recomputed without the records.
nlohmann::json basis_of(const validate::diagnose::Diagnosis& d) {
  const auto input = [&](const validate::reduced::FreeInput& m) {
    return nlohmann::json{{"evidence", m.evidence},
                          {"chi2", validate::fit::gain(d.base, m.fit, validate::fit::data_cost)},
                          {"reduced_chi2", m.reduced_chi2()}};
  };
  nlohmann::json j = {{"values", d.base.values},
                      {"reduced_chi2", d.base.reduced_chi2()},
                      {"slow", validate::noise::slow_remainder(d.base.events, d.events)},
                      {"line", validate::noise::strongest_line(d.base.events, d.events).explains},
                      {"torque", input(d.torque)},
                      {"field", input(d.field)},
                      {"hypotheses", nlohmann::json::array()}};
  for (const validate::hypothesis::Judgement& h : d.ranked) {
    if (!h.fitted || !h.fit.failed.empty()) continue;
    nlohmann::json one = {{"name", validate::hypothesis::full_name(h.hypothesis)},
                          {"slot", h.hypothesis.slot},
                          {"evidence", h.gain},
                          {"chi2", validate::fit::gain(d.base, h.fit, validate::fit::data_cost)},
                          {"reduced_chi2", h.fit.reduced_chi2()},
                          {"free", h.hypothesis.free.size()},
                          {"accepted", h.accepted},
                          {"why_not", h.why_not}};
    for (const auto& u : h.held_out) one["unseen"].push_back({u.cost_before, u.cost_after, u.values});
    j["hypotheses"].push_back(std::move(one));
  }
  return j;
}

BlindVerdict verdict_of(const validate::diagnose::Diagnosis& d) {
  BlindVerdict v;
  v.verdict = validate::diagnose::verdict_name(d.verdict);
  v.side = validate::hypothesis::side_name(d.side);
  v.effects = d.effects;
  v.set = d.equivalent;
  v.why = d.sentence;
  for (const auto& e : d.probabilities) v.probabilities.emplace_back(e.name, e.probability);
  v.basis = basis_of(d);
  if (d.verdict == validate::diagnose::Verdict::adequate && d.wrong)
    for (const validate::fit::WrongParameter& w : d.wrong->wrong) v.wrong.push_back(w.fit.full_name());
  if (v.effects.empty() && d.verdict == validate::diagnose::Verdict::confusable && !v.set.empty())
    v.effects = {v.set.front()};
  return v;
}

}  // namespace

SeenCase read_seen_case(const fs::path& folder) {
  SeenCase e{validate::plant::load_plant_model(folder / "model.toml"), {}};
  std::optional<validate::event::MeasuredPoint> point;
  if (const fs::path file = folder / "point.toml"; fs::exists(file))
    point = validate::event::load_point(file, e.model);
  for (const auto& file : event_files(folder)) {
    validate::record::Record record = validate::record::read_record(file, e.model.record_base);
    e.records.push_back(point ? validate::event::of_tried_unit(*point, std::move(record))
                              : std::move(record));
  }
  return e;
}

BlindJudge diagnosis_judge(const validate::diagnose::DiagnoseOptions& options) {
  return [options](const fs::path& folder) {
    const auto begin = std::chrono::steady_clock::now();
    BlindVerdict verdict;
    try {
      SeenCase seen = read_seen_case(folder);
      verdict = verdict_of(validate::diagnose::diagnose(seen.model, std::move(seen.records), options));
    } catch (const InputError& error) {
      verdict.verdict = "refused";
      verdict.why = error.what();
    }
    verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return verdict;
  };
}

}  // namespace swingbank::research::blind::score
