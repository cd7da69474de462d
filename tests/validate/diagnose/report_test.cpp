// The page and the JSON of a diagnosis agree, and a browser renders the page without errors.
#include "validate/diagnose/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "base/json.hpp"
#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "tests/validate/report/browser.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::diagnose {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

/// Two events of the example; the model lacks the plant's exciter. The fits are short, because the test is
/// about the report, not about their quality.
struct Example {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  Diagnosis d;
  report::Provenance rows;
  Example() {
    std::vector<record::Record> records;
    for (const char* name : {"avr_ev1.csv", "avr_ev3.csv"})
      records.push_back(record::read_record(
          test::source(std::string("configs/records/record-example/") + name), model.record_base));
    d.events = noise::whitened_events(model, std::move(records));
    fit::FitOptions brief;
    brief.iterations = 2;
    d.base = fit::fit(model.under_test(), d.events, fit::free_parameters(model.plant, 0.2), brief);
    if (!d.base.failed.empty()) throw std::runtime_error(d.base.failed);
    for (hypothesis::Hypothesis& h : hypothesis::all_hypotheses(model.under_test(), model.library)) {
      if (h.name.find("SEXS") == std::string::npos || !d.ranked.empty()) continue;
      hypothesis::Judgement j;
      j.fit = fit::fit({hypothesis::started(h, h.starts.front()), h.conventions}, d.events, h.free, brief);
      if (!j.fit.failed.empty()) throw std::runtime_error(j.fit.failed);
      j.gain = d.base.chi2 - j.fit.chi2;
      j.accepted = true;
      for (const event::FitEvent& e : d.events) j.held_out.push_back({e.record.name, 400, 2.25});
      j.hypothesis = std::move(h);
      d.ranked.push_back(std::move(j));
    }
    hypothesis::Judgement refused = d.ranked.front();
    refused.hypothesis.name = "A < B";  // must be escaped
    refused.accepted = false;
    refused.gain = 3;
    refused.why_not = "evidence 3, below 25";
    refused.held_out.clear();
    d.ranked.push_back(refused);
    d.field.kind = fit::InputKind::field;
    d.field.fit = d.base;
    for (auto& e : d.field.fit.events) {
      e.state.field = {{0, 2, 3, 15}, {0, 0, 0.8, 0.1}};
      d.field.deviation.emplace_back(Eigen::VectorXd::Constant(4, 0.05));
    }
    d.verdict = Verdict::missing;
    d.side = hypothesis::Side::excitation;
    d.effects = {d.ranked.front().hypothesis.name};
    d.sentence = "The exciter <SEXS> is missing.";
    rows = diagnosis_provenance(model, d, "swingbank diagnose --model <m>");
  }
};
const Example& example() {
  static const Example e;
  return e;
}
nlohmann::json figures() { return diagnosis_json(example().model, example().d, example().rows); }
const std::string& page() {
  static const std::string html =
      diagnosis_html(example().model, example().d, example().rows,
                     play_models(example().model, example().d, thresholds::read_acceptance("")));
  return html;
}

/// Texts of the rows of the table after `caption`, entities resolved.
std::vector<std::vector<std::string>> table_after(const std::string& html, const std::string& caption) {
  const auto begin = html.find("<tbody>", html.find(caption)), end = html.find("</tbody>", begin);
  std::vector<std::vector<std::string>> rows;
  const std::string body = html.substr(begin, end - begin);
  static const std::regex row("<tr>(.*?)</tr>"), cell("<td[^>]*>([^<]*)</td>"), gt("&gt;"), lt("&lt;");
  for (std::sregex_iterator r(body.begin(), body.end(), row), none; r != none; ++r) {
    const std::string text = (*r)[1];
    rows.emplace_back();
    for (std::sregex_iterator c(text.begin(), text.end(), cell); c != none; ++c)
      rows.back().push_back(std::regex_replace(std::regex_replace((*c)[1].str(), gt, ">"), lt, "<"));
  }
  return rows;
}
/// The symbol of a parameter in engineering notation.
std::string symbol(const std::string& block, const std::string& name) {
  for (const auto& p : sim::library::compiled().find(block)->parameters)
    if (p.name == name) return std::string(p.symbol);
  return "";
}
std::string cell_text(const nlohmann::json& cell) {
  if (cell["normalised_rms"].is_null()) return "–";
  const double ratio = cell["normalised_rms"];
  return report::times_noise(ratio) + (ratio > cell["normalised_bound"].get<double>() ? " *" : "");
}

/// An inferred input has a time series with limits, and no fitted parameters.
TEST(DiagnosisReportTest, InferredInputHasLimitsAndNoParameterTable) {
  Diagnosis d = example().d;
  d.verdict = Verdict::unexplained;
  for (hypothesis::Judgement& j : d.ranked) j.accepted = false;
  d.field.fit.parameters.clear();
  const std::string html = diagnosis_html(example().model, d, example().rows, {});
  EXPECT_NE(html.find("upper 95 % limit"), std::string::npos);
  EXPECT_EQ(html.find(">Parameters<"), std::string::npos);
  EXPECT_NE(page().find(">Parameters<"), std::string::npos);
}

TEST(DiagnosisReportTest, ErrorMapsEqualTheJson) {
  const auto j = figures();
  ASSERT_EQ(j["events"].size(), 2u);
  for (const auto& e : j["events"]) {
    const auto rows = table_after(page(), "Error map of " + e["record"].get<std::string>());
    std::vector<std::vector<std::string>> expected;
    for (const auto& c : e["channels"]) {
      const auto& map = c["map_after"];
      for (std::size_t i = 0; i + 1 < map.size();
           i += 5) {  // each window has five rows, the total and four bands; the whole record comes last
        const double rms = map[i]["rms_pu"].get<double>() * c["units_in_pu"].get<double>();
        expected.push_back({c["name"], map[i]["window"], ""});
        char text[64];
        std::snprintf(text, sizeof text, "%.3g %s", rms, c["unit"].get<std::string>().c_str());
        expected.back()[2] = text;
        for (std::size_t b = 0; b < 5; ++b) expected.back().push_back(cell_text(map[i + b]));
      }
    }
    EXPECT_EQ(rows, expected);
  }
}
TEST(DiagnosisReportTest, TablesEqualTheJson) {
  const auto j = figures();
  const auto at_a_glance = table_after(page(), "Error of each event");
  ASSERT_EQ(at_a_glance.size(), 2u);
  for (std::size_t e = 0; e < 2; ++e) {
    const auto& event = j["events"][e];
    EXPECT_THAT(at_a_glance[e], ElementsAreArray({event["record"].get<std::string>(),
                                                  report::times_noise(event["normalised_rms_before"]),
                                                  report::times_noise(event["normalised_rms_after"]),
                                                  std::string("20 ×"), std::string("1.5 ×")}));
  }
  const auto parameters = table_after(page(), "95 % intervals.");
  const auto& written = j["after"]["parameters"];
  ASSERT_EQ(parameters.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_EQ(parameters[i][0], written[i]["effect"].get<std::string>() + " " +
                                    symbol(written[i]["effect"], written[i]["name"]));
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", written[i]["value"].get<double>());
    EXPECT_EQ(parameters[i][4], text);
  }
  EXPECT_EQ(j["hypotheses"][1]["name"], "A < B");
  EXPECT_EQ(j["missing_field_voltage"]["events"][0]["value_pu"][2], 0.8);
  EXPECT_TRUE(j["missing_torque"].is_null());
}
TEST(DiagnosisReportTest, ErrorFallsWithTheAddedEffect) {
  const auto j = figures();  // even after a short fit, the model with an exciter is nearer to the truth than
                             // the model without
  EXPECT_LT(j["after"]["normalised_rms"], j["before"]["normalised_rms"]);
}
TEST(DiagnosisReportTest, VerdictIsFirst) {
  const auto verdict = page().find("The exciter &lt;SEXS&gt; is missing.");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, page().find("<table"));
  EXPECT_LT(verdict, page().find("<h2"));
}
TEST(DiagnosisReportTest, HeadlineNamesTheEffectWithItsProbability) {
  Diagnosis d = example().d;
  d.probabilities = {{"SEXS", 0, 0, 0.8}, {"none of these", 0, -1, 0.2}};
  EXPECT_THAT(diagnosis_html(example().model, d, {}), HasSubstr(">SEXS is missing (80 %)</p>"));
  d.effects = {"SEXS"};
  EXPECT_THAT(
      diagnosis_html(example().model, d, {{"command", "swingbank diagnose --model m --out o --records r"}}),
      HasSubstr("<code>swingbank add SEXS --model m --records r</code>"));
}
TEST(DiagnosisReportTest, AdequateModelNeedsNoEffect) {
  Diagnosis d = example().d;
  d.verdict = Verdict::adequate;
  d.sentence = "The model is adequate.";
  const auto j = diagnosis_json(example().model, d, {});
  EXPECT_TRUE(j["after"].is_null());
  EXPECT_FALSE(j["events"][0]["channels"][0].contains("map_after"));
  EXPECT_THAT(diagnosis_html(example().model, d, {}), HasSubstr("headline good"));
}
TEST(DiagnosisReportTest, ShowsUnexplainedResidualAsInferredInput) {
  Diagnosis d = example().d;
  d.verdict = Verdict::unexplained;
  d.ranked.front().accepted = false;
  const auto j = diagnosis_json(example().model, d, {});
  EXPECT_EQ(j["after"]["with"], "the inferred field voltage");
  EXPECT_THAT(diagnosis_html(example().model, d, {}), HasSubstr("headline bad"));
}

/// The example without an accepted effect, with an accepted user-defined model for the field voltage and a
/// rejected second one.
Diagnosis with_user_models() {
  Diagnosis d = example().d;
  d.user_models.kind = fit::InputKind::field;
  d.user_models.ranked.resize(7);
  user_model_search::UserModelFinding found;
  for (std::size_t e = 0; e < d.events.size(); ++e) {
    user_model_search::UserModelTrace trace;
    trace.t = {0, 1, 2, 3, 4};
    for (auto& signal : trace.signal) signal = {0, 0.1, -0.2, 0.3, 0.1};
    trace.knots = {0, 2, 4};
    trace.input = {0, 0.5, 0.25};
    d.user_models.traces.push_back(trace);
    found.user_model.time_series.push_back({0, 0.375, 0.125});
  }
  found.user_model.family = "lagged";
  found.user_model.signal = "V";
  found.user_model.explained = 0.83;
  found.words = "-20 * V < 0.5";
  found.judgement = d.ranked.front();
  found.judgement.hypothesis.name = "LAW1";
  found.judgement.accepted = true;
  user_model_search::UserModelFinding refused = found;
  refused.judgement.hypothesis.name = "LAW2";
  refused.judgement.accepted = false;
  refused.judgement.why_not = "it worsens <ev3>";
  refused.judgement.held_out.clear();
  d.user_models.findings = {found, refused};
  return d;
}

TEST(DiagnosisReportTest, PageShowsTheUserModelsOfTheJson) {
  const Diagnosis d = with_user_models();
  const std::string html = diagnosis_html(example().model, d, {});
  const auto section = html.find("User-defined model");
  ASSERT_NE(section, std::string::npos);
  EXPECT_THAT(html, HasSubstr("7 model structures (proportional"));
  EXPECT_THAT(html, HasSubstr("Found: -20 * V &lt; 0.5."));
  EXPECT_THAT(html, HasSubstr("inferred field voltage"));
  const auto rows = table_after(html.substr(section), "explained share of the inferred input");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0][0], "LAW1");
  EXPECT_EQ(rows[0][1], "83 %");
  EXPECT_EQ(rows[0][4], "≤ 1.50 ×");  // the example's chi2 per value outside the fit is 2.25
  EXPECT_EQ(rows[0][5], "accepted");
  EXPECT_EQ(rows[1][4], "–");
  EXPECT_EQ(rows[1][5], "it worsens <ev3>");
  const auto written = diagnosis_json(example().model, d, {})["user_defined_models"];
  EXPECT_EQ(written["input"], "field_voltage");
  EXPECT_EQ(written["found"], "LAW1");
  EXPECT_EQ(written["fitted"][1]["why_not"], "it worsens <ev3>");
}
TEST(DiagnosisReportTest, ReportsThatNoUserDefinedModelFits) {
  Diagnosis d = with_user_models();
  d.user_models.findings.erase(d.user_models.findings.begin());
  const std::string html = diagnosis_html(example().model, d, {});
  EXPECT_THAT(html, HasSubstr("No user-defined model predicts held-out events; none is accepted."));
  EXPECT_THAT(html, testing::Not(HasSubstr("Found:")));
  EXPECT_TRUE(diagnosis_json(example().model, d, {})["user_defined_models"]["found"].is_null());
}
TEST(DiagnosisReportTest, PageOmitsUserModels_WithoutASearch) {
  EXPECT_THAT(page(), testing::Not(HasSubstr("User-defined model")));
  EXPECT_TRUE(figures()["user_defined_models"].is_null());
}

TEST(DiagnosisPageTest, RendersInABrowser) {
  // A user zooms by a drag from 30 % to 60 % of the first chart's width, then double-clicks to zoom out.
  const std::string act = R"js(<script>
    const box=document.querySelector(".u-over"), r=box.getBoundingClientRect(), state=()=>charts_of_test().map((c)=>({group:c.of.group,x:c.x,
      part:c.box.closest("figure").querySelector(".part").textContent}));
    const mouse=(what,x,on=box)=>on.dispatchEvent(new MouseEvent(what,{bubbles:true,cancelable:true,view:window,button:0,buttons:1,movementX:1,
      clientX:r.left+x*r.width,clientY:r.top+60}));
    const result={first:state(),figures:JSON.parse(document.getElementById("figures").textContent)};
    mouse("mousemove",.3);mouse("mousedown",.3);mouse("mousemove",.6);mouse("mouseup",.6,document);
    setTimeout(()=>{result.zoomed=state();mouse("dblclick",.5);
      setTimeout(()=>{result.whole=state();
        [...document.querySelectorAll(".chips a")].pop().click();
        result.open=document.querySelectorAll("details[open]").length;
        result.charts=document.querySelectorAll(".chart canvas").length;
        result.wide=document.documentElement.scrollWidth;result.inner=innerWidth;
        document.body.dataset.result=JSON.stringify(result)},200)},200);
  </script>)js";
  const test::Shown shown = test::show(page(), act);
  EXPECT_EQ(shown.complaints, "");
  const auto& result = shown.result;
  EXPECT_EQ(result["figures"], figures());
  EXPECT_GT(result["charts"].get<int>(), 12);  // including charts in folded sections
  const auto range = [&](const char* when, std::size_t chart) -> std::pair<double, double> {
    return {result[when][chart]["x"][0], result[when][chart]["x"][1]};
  };
  const auto [from, to] = range("first", 0);  // 1 s before to 5 s after the first switching
  EXPECT_NEAR(to - from, 6, 1e-6);
  EXPECT_NEAR(range("zoomed", 0).first, from + 0.3 * 6, 0.1);
  EXPECT_NEAR(range("zoomed", 0).second, from + 0.6 * 6, 0.1);
  EXPECT_GT(range("whole", 0).second - range("whole", 0).first, 14);
  // The caption states the shown part, since paper has no zoom.
  EXPECT_THAT(result["first"][0]["part"].get<std::string>(),
              testing::MatchesRegex("t = .* to .* s of 0 to 15 s"));
  EXPECT_NE(result["zoomed"][0]["part"], result["first"][0]["part"]);
  EXPECT_EQ(result["whole"][0]["part"], "");
  const auto& group = result["first"][0]["group"];
  std::size_t same = 0;
  for (std::size_t k = 0; k < result["first"].size(); ++k) {
    const bool follows = result["first"][k]["group"] == group;
    same += follows;
    EXPECT_EQ(range("zoomed", k) == range("zoomed", 0), follows) << k;  // the event's charts share the range
  }
  EXPECT_GT(same, 4U);
  EXPECT_EQ(result["open"], 1);                // a chip opens the event of its chart
  EXPECT_LE(result["wide"], result["inner"]);  // on a telephone only tables need horizontal scrolling
}
TEST(DiagnosisPageTest, DetectsBrowserErrors) {
  EXPECT_THAT(
      test::show("<!doctype html><body>", "<script>document.body.dataset.result='1';nothing.there()</script>")
          .complaints,
      HasSubstr("nothing is not defined"));
}

}  // namespace
}  // namespace swingbank::validate::diagnose
