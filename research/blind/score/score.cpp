#include "research/blind/score/score.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "base/config.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::research::blind::score {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char *kPowerOnly = "P, Q only", *kWithChannels = "with speed, Ifd";
constexpr double kFrom = 2.0;  ///< smallest size that counts in the rates [detection limits]

bool same(const std::string& a, const std::string& b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}
bool among(const std::vector<std::string>& list, const std::string& name) {
  return std::ranges::any_of(list, [&](const std::string& one) { return same(one, name); });
}
bool share(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return std::ranges::any_of(a, [&](const std::string& one) { return among(b, one); });
}

/// Splits "A + B" into its effects.
std::vector<std::string> together(const std::string& entry) {
  constexpr std::string_view kAnd = " + ";
  std::vector<std::string> names;
  for (std::size_t from = 0, to = 0; to != std::string::npos; from = to + kAnd.size()) {
    to = entry.find(kAnd, from);
    names.push_back(entry.substr(from, to - from));
  }
  return names;
}

ScoredCase read_truth(const fs::path& file) {
  std::ifstream in(file);
  const json j = json::parse(in, nullptr, false);
  try {
    ScoredCase c;
    c.name = j.at("case");
    c.channels = j.at("channels").get<std::string>() != "P,Q";
    c.size = j.at("hidden").empty() ? 0.0 : 1e300;
    c.conditions = j.value("conditions", c.conditions);
    for (const auto& h : j.at("hidden")) {
      c.kinds.push_back(h.at("kind"));
      c.sides.push_back(h.at("side"));
      c.accepted_names.push_back(h.at("answers"));
      c.listed = c.listed && h.at("listed").get<bool>();
      c.value = h.value("value", false);
      c.size = std::min(c.size, h.at("left_noise").get<double>() / h.at("limit_noise").get<double>());
    }
    return c;
  } catch (const json::exception& error) {
    throw InputError(
        {"truth of a blind case cannot be read", file.string(), error.what(), "make the case again"});
  }
}

std::string row_of(const ScoredCase& c) {
  if (c.kinds.empty()) return "nothing";
  std::string row;
  for (const auto& kind : c.kinds) row += (row.empty() ? "" : " + ") + kind;
  return c.kinds.size() > 1 ? "two effects" : row;
}

std::string said(const BlindVerdict& v) {
  if ((v.verdict == "missing" || v.verdict == "confusable") && !v.effects.empty()) return v.effects.front();
  return v.verdict;
}

void count_single(const ScoredCase& c, BlindScore& score) {
  const std::string with = c.channels ? kWithChannels : kPowerOnly;
  std::size_t cls = 0;
  for (std::size_t k = 0; k < std::size(kSizeEdges); ++k)
    if (c.size >= kSizeEdges[k]) cls = k;
  auto& sizes = score.by_size[with];
  sizes.resize(std::size(kSizeEdges));
  sizes[cls].count(c.first_right());
  if (c.size < kFrom) return;
  score.rates["right first, " + with].count(c.first_right());
  score.rates["right or in the set, " + with].count(c.right_or_in_set());
}

void count(const ScoredCase& c, BlindScore& score) {
  const BlindVerdict& v = c.verdict;
  ++score.confusion[row_of(c)][said(v)];
  if (c.kinds.empty()) {
    score.rates["nothing hidden: adequate"].count(v.verdict == "adequate");
    score.rates["false positive"].count(v.verdict == "missing" || v.verdict == "confusable");
    return;
  }
  if (c.value) {
    score.rates["wrong value: nothing missing"].count(v.verdict == "adequate");
    score.rates["wrong value: named"].count(c.values_named());
    score.rates["wrong value: named and no other"].count(c.values_named() &&
                                                         v.wrong.size() == c.accepted_names.front().size());
    return;
  }
  if (c.size >= kFrom) score.rates["side"].count(c.side_right());
  if (c.kinds.size() > 1) {
    score.rates["two effects: both named"].count(c.all_named());
    score.rates["two effects: both named or in the set"].count(c.all_in_set());
    score.rates["two effects: not adequate"].count(v.verdict != "adequate");
  } else if (!c.listed) {
    score.rates["outside the list: none of these"].count(v.verdict == "unexplained");
  } else {
    count_single(c, score);
  }
}

void count_conditions(const ScoredCase& c, BlindScore& score) {
  const std::string& verdict = c.verdict.verdict;
  for (const std::string& condition : c.conditions) {
    ByCondition& at = score.by_condition[condition];
    if (c.kinds.empty())
      at.nothing.count(verdict == "adequate");
    else if (c.value)
      at.value.count(c.values_named());
    else if (!c.listed)
      at.outside.count(verdict == "unexplained");
    else if (c.kinds.size() == 1 && c.size >= kFrom)
      at.one.count(c.right_or_in_set());
  }
}

std::map<std::string, double> read_targets(const fs::path& file) {
  Config config(file);
  std::map<std::string, double> targets;
  for (const auto& key : config.keys("target")) {
    const auto name = config.require<std::string>("target." + key + ".rate");
    targets[name] = config.require<double>("target." + key + ".at_least", {0.0, 1.0});
  }
  config.raise();
  return targets;
}

}  // namespace

bool ScoredCase::first_right() const {
  return (verdict.verdict == "missing" || verdict.verdict == "confusable") && !verdict.effects.empty() &&
         std::ranges::any_of(accepted_names,
                             [&](const auto& a) { return among(a, verdict.effects.front()); });
}
bool ScoredCase::right_or_in_set() const {
  return first_right() ||
         (verdict.verdict == "confusable" &&
          std::ranges::any_of(accepted_names, [&](const auto& a) { return share(a, verdict.set); }));
}
bool ScoredCase::all_named() const {
  return !accepted_names.empty() &&
         std::ranges::all_of(accepted_names, [&](const auto& a) { return share(a, verdict.effects); });
}
bool ScoredCase::all_in_set() const {
  const auto names_all = [&](const std::string& entry) {
    return std::ranges::all_of(accepted_names, [&](const auto& a) { return share(a, together(entry)); });
  };
  return all_named() || (verdict.verdict == "confusable" && !accepted_names.empty() &&
                         std::ranges::any_of(verdict.set, names_all));
}
bool ScoredCase::values_named() const {
  return verdict.verdict == "adequate" &&
         std::ranges::all_of(accepted_names.front(),
                             [&](const std::string& one) { return among(verdict.wrong, one); });
}
bool ScoredCase::side_right() const { return among(sides, verdict.side); }

Forecast ScoredCase::forecast() const {
  Forecast f;
  f.group = channels ? kWithChannels : kPowerOnly;
  f.listed = listed && kinds.size() == 1 && !value;
  const auto is_truth = [&](const std::string& explanation) {
    if (nothing_missing()) return false;
    if (!listed) return explanation == validate::hypothesis::kNoneOfThese;
    const auto said = together(explanation);
    return said.size() == accepted_names.size() &&
           std::ranges::all_of(accepted_names, [&](const auto& a) { return share(a, said); });
  };
  std::vector<std::pair<double, char>> said;
  double nothing = 0;  // probability of all explanations without a missing effect
  for (const auto& [explanation, probability] : verdict.probabilities)
    if (explanation.starts_with(validate::hypothesis::kNothingMissing))
      nothing += probability;
    else
      said.emplace_back(probability, is_truth(explanation) ? 1 : 0);
  if (!verdict.probabilities.empty()) said.emplace_back(nothing, nothing_missing() ? 1 : 0);
  std::ranges::stable_sort(said, std::greater<>(), &std::pair<double, char>::first);
  for (const auto& [probability, right] : said) {
    f.probabilities.push_back(probability);
    f.right.push_back(right);
  }
  return f;
}

BlindScore score_blind(const fs::path& run, const fs::path& targets) {
  BlindScore score;
  score.targets = read_targets(targets);
  std::vector<fs::path> files;
  if (!fs::is_directory(run / "truth"))
    throw InputError({"no cases of a blind test", run.string(), "the folder has no subfolder truth",
                      "make cases first, with --make"});
  for (const auto& entry : fs::directory_iterator(run / "truth"))
    if (entry.path().extension() == ".json" && fs::exists(run / "cases" / entry.path().stem()))
      files.push_back(entry.path());
  std::ranges::sort(files);
  Problems problems;
  std::vector<double> seconds;
  for (const auto& file : files) {
    const fs::path verdict = run / "verdicts" / file.filename();
    if (!fs::exists(verdict)) {
      score.unjudged.push_back(file.stem().string());
      continue;
    }
    try {
      ScoredCase c = read_truth(file);
      c.verdict = read_verdict(verdict);
      seconds.push_back(c.verdict.seconds);
      count(c, score);
      count_conditions(c, score);
      score.cases.push_back(std::move(c));
    } catch (const InputError& error) {
      problems.add(error);
    }
  }
  problems.raise();
  std::vector<Forecast> forecasts;
  for (const ScoredCase& c : score.cases) forecasts.push_back(c.forecast());
  score.reliability = reliability(forecasts);
  std::ranges::sort(seconds);
  if (!seconds.empty()) {
    score.median_seconds = seconds[seconds.size() / 2];
    score.longest_seconds = seconds.back();
  }
  return score;
}

}  // namespace swingbank::research::blind::score
