#include "validate/benchmark/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/thresholds/adequacy.hpp"

namespace swingbank::validate::benchmark {
namespace {

using compare::JudgedErrors;

/// Largest ratio of an error of P or Q to its limit, and its description.
struct NearestLimit {
  double ratio = -1;
  std::string text;
};
NearestLimit nearest_limit(const TestResult& r) {
  NearestLimit most;
  for (const JudgedErrors& row : r.rows) {
    if (!has_limits(row.channel)) continue;
    const thresholds::Nearest at = thresholds::nearest(row.errors, row.limits);
    if (!(at.ratio > most.ratio)) continue;
    most = {at.ratio, fmt::format("{} of {}, {}: {:.3g} %, limit {:g} %", at.name, row.channel,
                                  window_name(row.phase), at.error, at.limit)};
  }
  for (const compare::Movement& m : r.fitness.movements)
    if (const double ratio = m.error / m.limit; !(ratio <= most.ratio))
      most = {ratio,
              fmt::format("RMS error of {}, post: {:.3g} % of the reference's RMS deviation, limit {:g} %",
                          m.channel, m.error, m.limit)};
  return most;
}

std::string times_text(const Test& t) {
  std::string text = fmt::format("{:g} s", t.event);
  if (t.end) text += fmt::format(" to {:g} s", *t.end);
  if (t.kind == TestKind::scr_step && t.grid)
    return text + fmt::format(", SCR {:g} to {:g}", t.grid->scr, t.grid->scr + t.size.value_or(0));
  if (t.size) text += fmt::format(", {:+g} {}", *t.size, size_unit(t.kind));
  if (t.grid) text += fmt::format(", SCR {:g}", t.grid->scr);
  return text;
}

/// Cell of one error: "0.42 of 5 %", or "0.42 %" if there is no limit. A star marks an exceeded limit.
report::Cell error_cell(double error, double limit, bool limited) {
  if (!std::isfinite(error)) return {"not finite *", 1.0};
  const std::string value = fmt::format("{:.3g}", std::abs(error) < 5e-5 ? 0.0 : error);
  if (!limited) return {value + " %"};
  const bool within = std::abs(error) <= limit;
  return {fmt::format("{} of {:g} %{}", value, limit, within ? "" : " *"), within ? 0.0 : 1.0};
}

bool row_passes(const JudgedErrors& row) { return thresholds::exceeding(row.errors, row.limits) == 0; }

int count_passed(const std::vector<TestResult>& results) {
  return static_cast<int>(std::ranges::count_if(results, &TestResult::passes));
}

/// Returns the test with the largest error relative to its limit; null if the simulation failed in all tests.
const TestResult* worst_test(const std::vector<TestResult>& results) {
  const TestResult* worst = nullptr;
  for (const TestResult& r : results)
    if (r.failure.empty() && (!worst || nearest_limit(r).ratio > nearest_limit(*worst).ratio)) worst = &r;
  return worst;
}

std::string verdict_sentence(const std::vector<TestResult>& results, const ReportContext& c) {
  std::string text = fmt::format("{} of {} tests are within the limits {} ({}).", count_passed(results),
                                 results.size(), c.by.name, c.by.source);
  const TestResult* worst = worst_test(results);
  if (worst)
    text += fmt::format(" {}: {}, in {}.",
                        nearest_limit(*worst).ratio > 1 ? "Largest violation" : "Nearest to its limit",
                        nearest_limit(*worst).text, worst->test.name);
  return text;
}

nlohmann::json errors_of(const thresholds::Errors& e, double scale) {
  return {{"mxe", e.mxe * scale}, {"me", e.me * scale}, {"mae", e.mae * scale}};
}

nlohmann::json test_json(const TestResult& r) {
  const Test& t = r.test;
  nlohmann::json j = {{"name", t.name},
                      {"kind", kind_name(t.kind)},
                      {"record", t.record.filename().string()},
                      {"record_sha256", r.event.record.sha256},
                      {"passes", r.passes()},
                      {"failure", r.failure},
                      {"event_s", t.event},
                      {"end_s", t.end ? nlohmann::json(*t.end) : nullptr},
                      {"size", t.size ? nlohmann::json(*t.size) : nullptr},
                      {"size_unit", size_unit(t.kind)},
                      {"scr", t.grid ? nlohmann::json(t.grid->scr) : nullptr},
                      {"x_over_r", t.grid ? nlohmann::json(t.grid->x_over_r) : nullptr},
                      {"windows", nlohmann::json::array()},
                      {"errors", nlohmann::json::array()},
                      {"movement", nlohmann::json::array()}};
  for (const auto& w : r.event.windows)
    j["windows"].push_back({{"name", w.name}, {"from_s", w.from}, {"to_s", w.to}});
  for (const JudgedErrors& row : r.rows) {
    nlohmann::json one = {{"channel", row.channel},
                          {"window", window_name(row.phase)},
                          {"samples", row.samples},
                          {"percent", errors_of(row.errors, 1)},
                          {"pu", errors_of(row.errors, 0.01)}};
    one["limits_percent"] = has_limits(row.channel) ? errors_of(row.limits, 1) : nlohmann::json(nullptr);
    one["passes"] = has_limits(row.channel) ? nlohmann::json(row_passes(row)) : nlohmann::json(nullptr);
    j["errors"].push_back(std::move(one));
  }
  for (const compare::Movement& m : r.fitness.movements)
    j["movement"].push_back({{"channel", m.channel},
                             {"unit", m.unit},
                             {"reference_rms", m.measured},
                             {"error_percent", m.error},
                             {"limit_percent", m.limit},
                             {"passes", !m.exceeds()}});
  return j;
}

constexpr std::size_t kChartPoints = 5000;  ///< largest number of points per curve, several per screen pixel

/// Returns the chart with every n-th sample. A page with all samples of long EMT records would be too large
/// for a browser.
report::Curves thinned(report::Curves c) {
  const std::size_t every = c.x.size() / kChartPoints + 1;
  const auto thin = [every](std::vector<double>& values) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < values.size(); k += every) values[kept++] = values[k];
    values.resize(kept);
  };
  thin(c.x);
  for (auto& series : c.series) thin(series.y);
  return c;
}

/// Returns the chart of one channel: reference and model.
report::Curves channel_chart(const TestResult& r, const compare::ChannelComparison& channel,
                             const std::string& reference) {
  report::Curves c = compare::event_chart(r.event, channel.name, channel.unit);
  c.series.push_back({reference, report::Ink::measured, compare::scaled(channel.measured, channel.scale)});
  c.series.push_back({"model", report::Ink::fitted, compare::scaled(channel.modelled, channel.scale)});
  return thinned(std::move(c));
}

/// Adds the charts of P and Q of one test side by side.
void large_charts(report::Document& page, const TestResult& r, const std::string& reference) {
  page.subsection(fmt::format("{}: {}, {}", r.test.name, kind_name(r.test.kind), times_text(r.test)));
  page.add(report::Begin{report::Begin::Layout::large});
  for (const auto& channel : r.event.channels)
    if (has_limits(channel.name)) page.add(channel_chart(r, channel, reference));
  page.add(report::End{});
}

/// Adds the charts of one test: V and f, if they were played in, then each channel.
void charts(report::Document& page, const TestResult& r, const std::string& reference) {
  const compare::EventComparison& e = r.event;
  const double nominal = e.record.base.frequency;
  page.add(report::Begin{report::Begin::Layout::panels});
  const auto input = [&](const char* name, const char* unit, std::vector<double> y) {
    report::Curves c = compare::event_chart(e, std::string(name) + ", played in", unit);
    c.series.push_back({reference, report::Ink::measured, std::move(y)});
    page.add(thinned(std::move(c)));
  };
  if (!r.test.behind_impedance()) {
    input("V", "pu", e.record.V);
    input("f", "Hz",
          compare::scaled(compare::frequency_of(e.record.t, e.record.theta, nominal), nominal, nominal));
  }
  for (const auto& channel : e.channels) page.add(channel_chart(r, channel, reference));
  page.add(report::End{});
}

}  // namespace

report::Table summary_table(const std::vector<TestResult>& results) {
  report::Table table{"Verdict of each test, and the error with the largest ratio to its limit.",
                      {"test", "kind", "event", "verdict", "largest error / limit"},
                      {}};
  for (const TestResult& r : results)
    table.rows.push_back({r.test.name, std::string(kind_name(r.test.kind)), times_text(r.test),
                          report::Cell(r.passes() ? "pass" : "fail", r.passes() ? 0.0 : 1.0),
                          r.failure.empty() ? nearest_limit(r).text : r.failure});
  return table;
}

report::Table error_table(const std::vector<TestResult>& results, const ReportContext& c) {
  report::Table table{
      fmt::format(
          "Errors (model − reference): maximum error MXE, mean error ME, mean absolute error MAE, as "
          "defined in IEC 61400-27-2. P and Q in % of {:g} MVA, other channels in % of 1 pu; 1 % = 0.01 "
          "pu. Limits {}. Excluded: the first {:g} ms of the event and {:g} ms after its end. A star "
          "marks a value above its limit.",
          c.model.plant.mva, c.by.name, 1e3 * c.by.after_fault, 1e3 * c.by.after_clearing),
      {"test", "channel", "window", "samples", "MXE", "ME", "MAE"},
      {}};
  for (const TestResult& r : results)
    for (const JudgedErrors& row : r.rows) {
      const bool limited = has_limits(row.channel);
      table.rows.push_back({r.test.name, row.channel, std::string(window_name(row.phase)),
                            std::to_string(row.samples), error_cell(row.errors.mxe, row.limits.mxe, limited),
                            error_cell(row.errors.me, row.limits.me, limited),
                            error_cell(row.errors.mae, row.limits.mae, limited)});
    }
  return table;
}

std::string terminal_report(const std::vector<TestResult>& results, const ReportContext& c, bool verbose) {
  std::string text = fmt::format("{}: {} against {}\n{}\n\n{}", c.set.name, c.model.name, c.reference,
                                 verdict_sentence(results, c), report::padded(summary_table(results), 5));
  if (!verbose) return text + "(--verbose prints every error)\n";
  const report::Table errors = error_table(results, c);
  return text + "\n" + errors.caption + "\n" + report::padded(errors, 3);
}

std::string json_report(const std::vector<TestResult>& results, const ReportContext& c) {
  nlohmann::json j = {
      {"format", "swingbank-benchmark-1"},
      {"software", "swingbank " SWINGBANK_VERSION},
      {"model",
       {{"name", c.model.name},
        {"file", c.model.origin},
        {"sha256", c.model.sha256},
        {"mva", c.model.plant.mva}}},
      {"reference", c.reference},
      {"tests_file", {{"file", c.set.file.string()}, {"name", c.set.name}, {"source", c.set.source}}},
      {"limits",
       {{"name", c.by.name},
        {"source", c.by.source},
        {"after_fault_s", c.by.after_fault},
        {"after_clearing_s", c.by.after_clearing}}},
      {"passes", passes(results)},
      {"passed", count_passed(results)},
      {"sentence", verdict_sentence(results, c)},
      {"tests", nlohmann::json::array()},
      {"provenance", nlohmann::json::array()}};
  for (const TestResult& r : results) j["tests"].push_back(test_json(r));
  for (const auto& [name, value] : c.provenance)
    j["provenance"].push_back({{"what", name}, {"value", value}});
  return json_text(j, 2) + "\n";
}

std::string csv_report(const std::vector<TestResult>& results) {
  report::Table table{
      "",
      {"test", "kind", "channel", "window", "samples", "mxe_pu", "me_pu", "mae_pu", "mxe_percent",
       "me_percent", "mae_percent", "mxe_limit_percent", "me_limit_percent", "mae_limit_percent", "verdict"},
      {}};
  const auto number = [](double v) { return fmt::format("{:.9g}", v); };
  for (const TestResult& r : results) {
    for (const JudgedErrors& row : r.rows) {
      std::vector<report::Cell> cells = {r.test.name, std::string(kind_name(r.test.kind)), row.channel,
                                         std::string(window_name(row.phase)), std::to_string(row.samples)};
      for (const double scale : {0.01, 1.0})
        for (const double v : {row.errors.mxe, row.errors.me, row.errors.mae})
          cells.emplace_back(number(v * scale));
      const bool limited = has_limits(row.channel);
      for (const double v : {row.limits.mxe, row.limits.me, row.limits.mae})
        cells.emplace_back(limited ? number(v) : "");
      cells.emplace_back(!limited ? "" : row_passes(row) ? "pass" : "fail");
      table.rows.push_back(std::move(cells));
    }
    if (r.rows.empty()) {
      std::vector<report::Cell> cells(table.header.size(), "");
      cells.front() = r.test.name;
      cells[1] = std::string(kind_name(r.test.kind));
      cells.back() = "fail";
      table.rows.push_back(std::move(cells));
    }
  }
  return report::csv(table);
}

std::string csv_curves(const TestResult& r) {
  const compare::EventComparison& e = r.event;
  std::string text = "t_s,V_pu,theta_rad";
  for (const auto& c : e.channels) text += fmt::format(",{0}_reference_pu,{0}_model_pu", c.name);
  text += "\n";
  for (std::size_t k = 0; k < e.record.t.size(); ++k) {
    text += fmt::format("{:.9g},{:.9g},{:.9g}", e.record.t[k], e.record.V[k], e.record.theta[k]);
    for (const auto& c : e.channels) text += fmt::format(",{:.9g},{:.9g}", c.measured[k], c.modelled[k]);
    text += "\n";
  }
  return text;
}

std::string html_report(const std::vector<TestResult>& results, const ReportContext& c) {
  report::Document page{
      fmt::format("Benchmark: {} against {}", c.model.name, c.reference),
      fmt::format("{}; {} of {:g} MVA.", c.set.name, plant::subject(c.model), c.model.plant.mva)};
  const bool good = passes(results);
  page.add(report::Opening{
      good ? "Model passes all tests"
           : fmt::format("Model fails {} of {} tests",
                         results.size() - static_cast<std::size_t>(count_passed(results)), results.size()),
      {verdict_sentence(results, c)},
      good ? report::Tone::good : report::Tone::bad});
  if (const TestResult* worst = worst_test(results)) large_charts(page, *worst, c.reference);
  page.section("Tests");
  page.add(summary_table(results));
  page.section("Errors");
  page.add(error_table(results, c));
  std::vector<compare::Movement> movements;
  for (const TestResult& r : results)
    movements.insert(movements.end(), r.fitness.movements.begin(), r.fitness.movements.end());
  if (!movements.empty()) {
    compare::Fitness all;
    all.movements = std::move(movements);
    page.add(compare::movement_table(all));
  }
  page.section("Curves");
  page.add(report::Paragraph{
      "Voltage and angle of the reference are played into the model, except in tests behind the impedance of a "
      "grid (SCR), where both models are simulated. Drag across a chart to "
      "zoom (all charts of a test follow); double-click to see all of it. The grey band is the "
      "event. Curves of long records show at most 5000 samples; errors use all samples.",
      report::Paragraph::Kind::hint});
  for (const TestResult& r : results) {
    page.add(report::Begin{report::Begin::Layout::fold,
                           fmt::format("{} {}: {}, {}", r.passes() ? "✓" : "✕", r.test.name,
                                       kind_name(r.test.kind), times_text(r.test))});
    if (!r.failure.empty()) page.note("The simulation of this test failed: " + r.failure);
    charts(page, r, c.reference);
    page.add(report::End{});
  }
  page.add(report::Signatures{{"Owner", "Reviewer"}});
  page.provenance(c.provenance);
  page.add(report::Data{"figures", json_report(results, c)});
  return report::html(page);
}

}  // namespace swingbank::validate::benchmark
