// Score of a blind run as Markdown and JSON.
#include <fmt/format.h>

#include <set>

#include "research/blind/score/score.hpp"

namespace swingbank::research::blind::score {
namespace {

using nlohmann::json;

std::string percent(const Rate& r) {
  if (r.n == 0) return "–";
  return fmt::format("{:.1f} % ({} of {}; {:.1f}–{:.1f} %)", 100 * r.value(), r.hits, r.n, 100 * r.low(),
                     100 * r.high());
}

std::string rates(const BlindScore& score) {
  std::string text = "| rate | measured (n; 95 % interval) | target | |\n|---|---|---:|---|\n";
  std::set<std::string> all;
  for (const auto& [name, rate] : score.rates) all.insert(name);
  for (const auto& [name, least] : score.targets) all.insert(name);
  for (const auto& name : all) {
    const auto rate = score.rates.find(name);
    const auto least = score.targets.find(name);
    const Rate measured = rate == score.rates.end() ? Rate{} : rate->second;
    std::string met;
    if (least != score.targets.end())
      met = measured.n == 0 ? "not measured" : measured.value() >= least->second ? "met" : "**not met**";
    text +=
        fmt::format("| {} | {} | {} | {} |\n", name, percent(measured),
                    least == score.targets.end() ? "" : fmt::format("{:.0f} %", 100 * least->second), met);
  }
  return text;
}

std::string sizes(const BlindScore& score) {
  std::string text = "| records |", line = "|---|";
  const std::size_t n = std::size(kSizeEdges);
  for (std::size_t k = 0; k < n; ++k) {
    text += k + 1 < n ? fmt::format(" {:g}–{:g} × limit |", kSizeEdges[k], kSizeEdges[k + 1])
                      : fmt::format(" from {:g} × limit |", kSizeEdges[k]);
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const auto& [with, list] : score.by_size) {
    text += "| " + with + " |";
    for (const Rate& rate : list) text += " " + percent(rate) + " |";
    text += "\n";
  }
  return text;
}

std::string matrix(const BlindScore& score) {
  std::set<std::string> columns;
  for (const auto& [row, counts] : score.confusion)
    for (const auto& [column, n] : counts) columns.insert(column);
  std::string text = "| hidden \\ verdict |", line = "|---|";
  for (const auto& column : columns) {
    text += " " + column + " |";
    line += "---:|";
  }
  text += "\n" + line + "\n";
  for (const auto& [row, counts] : score.confusion) {
    text += "| " + row + " |";
    for (const auto& column : columns) {
      const auto at = counts.find(column);
      text += at == counts.end() ? " |" : fmt::format(" {} |", at->second);
    }
    text += "\n";
  }
  return text;
}

/// Returns the table of hit rates by field condition; empty without conditions.
std::string conditions(const BlindScore& score) {
  if (score.by_condition.empty()) return "";
  std::string text =
      "## Field conditions\n\n| condition | nothing hidden: adequate | one effect: first or in "
      "the set | wrong value: named | outside the list: none of these "
      "|\n|---|---|---|---|---|\n";
  for (const auto& [name, c] : score.by_condition)
    text += fmt::format("| {} | {} | {} | {} | {} |\n", name, percent(c.nothing), percent(c.one),
                        percent(c.value), percent(c.outside));
  return text + "\n";
}

json rate_json(const Rate& r) {
  return {{"hits", r.hits}, {"n", r.n}, {"rate", r.value()}, {"low", r.low()}, {"high", r.high()}};
}

}  // namespace

std::string score_markdown(const BlindScore& score) {
  return fmt::format(
      "# Blind test\n\n{} cases judged, {} without a verdict. Time per case: median {:.1f} s, "
      "longest {:.1f} s.\nRates of single effects and of the side count effects from 2 "
      "detection limits up.\n\n## Rates\n\n{}\n## Right effect first, by size\n\n{}\n{}## "
      "Confusion matrix\n\nFirst effect named, or the verdict where none was.\n\n{}{}",
      score.cases.size(), score.unjudged.size(), score.median_seconds, score.longest_seconds, rates(score),
      sizes(score), conditions(score), matrix(score), reliability_markdown(score.reliability));
}

json score_json(const BlindScore& score) {
  json all = {{"format", "swingbank-blind-score-1"},
              {"judged", score.cases.size()},
              {"unjudged", score.unjudged},
              {"median_seconds", score.median_seconds},
              {"longest_seconds", score.longest_seconds},
              {"targets", score.targets},
              {"confusion", score.confusion},
              {"size_edges_limits", kSizeEdges}};
  all["probabilities"] = reliability_json(score.reliability);
  for (const auto& [name, rate] : score.rates) all["rates"][name] = rate_json(rate);
  for (const auto& [with, list] : score.by_size)
    for (const Rate& rate : list) all["by_size"][with].push_back(rate_json(rate));
  for (const auto& [name, c] : score.by_condition)
    all["by_condition"][name] = {{"nothing", rate_json(c.nothing)},
                                 {"one", rate_json(c.one)},
                                 {"value", rate_json(c.value)},
                                 {"outside", rate_json(c.outside)}};
  for (const auto& c : score.cases)
    all["cases"].push_back({{"case", c.name},
                            {"hidden", c.kinds},
                            {"size_limits", c.size},
                            {"verdict", c.verdict.verdict},
                            {"effects", c.verdict.effects},
                            {"set", c.verdict.set},
                            {"side", c.verdict.side},
                            {"first_right", c.first_right()},
                            {"right_or_in_set", c.right_or_in_set()},
                            {"side_right", c.side_right()}});
  return all;
}

}  // namespace swingbank::research::blind::score
