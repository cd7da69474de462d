#include "validate/compare/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/json.hpp"
#include "tests/validate/compare/example.hpp"
#include "validate/compare/error_map_table.hpp"
#include "validate/compare/error_table.hpp"
#include "validate/compare/first_screen.hpp"
#include "validate/compare/report_json.hpp"
#include "validate/report/assets.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::compare {
namespace {

using ::testing::HasSubstr;

HandedIn handed(const std::vector<EventComparison>& events) { return handed_in(example_model(), events); }

/// The number at the beginning of a cell.
double number_in(const report::Cell& cell) { return std::stod(cell.text); }
TEST(ErrorTable, PrintedRatio_IsThePrintedRmsOverThePrintedNoise) {
  std::vector<EventComparison> events = {example_event()};
  judge(events);
  const Fitness fitness = fitness_of(events);
  for (const auto& played : {std::vector<Played>{{"", events, fitness}},
                             std::vector<Played>{{"one", events, fitness}, {"two", events, fitness}}}) {
    const report::Table table = error_table(played);
    EXPECT_EQ(table.rows.size(), events[0].channels.size());
    for (const auto& row : table.rows)
      for (std::size_t c = 2; c + 2 < 3 * played.size() + 2; c += 3) {
        const double ratio = number_in(row[c]) / number_in(row[c + 1]);
        EXPECT_NEAR(number_in(row[c + 2]), ratio, std::max(0.051, 0.51 * (ratio > 9.9))) << row[1].text;
      }
  }
  const auto json = errors_json({{"one", events, fitness}});
  const auto& q = events[0].channels[1];
  EXPECT_DOUBLE_EQ(json[1]["rms"], q.whole.rms * q.scale);
  EXPECT_DOUBLE_EQ(json[1]["rms_over_noise"], q.whole.rms / q.noise);
  EXPECT_THAT(terminal_report(example_model(), events, judge(events), fitness, handed(events), false),
              HasSubstr(report::padded(error_table({{"", events, fitness}}))));
}

TEST(CompareReportTest, JsonContainsTheNumbers) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  const auto j = nlohmann::json::parse(
      json_report(example_model(), events, adequacy, fitness_of(events), handed(events), {{"command", "x"}}));
  EXPECT_EQ(j["events"][0]["channels"][1]["name"], "Q");
  EXPECT_DOUBLE_EQ(j["events"][0]["channels"][1]["whole"]["rms_pu"], events[0].channels[1].whole.rms);
  EXPECT_EQ(j["events"][0]["channels"][1]["windows"].size(), 5u);
  const auto& map = j["events"][0]["channels"][1]["map"];
  ASSERT_EQ(map.size(), 5u * 5u + 1);  // windows times (all and four bands), and the whole record
  EXPECT_EQ(map[12]["window"], "0–1 s after");
  EXPECT_EQ(map[12]["band"], "0.1–0.8 Hz");
  EXPECT_DOUBLE_EQ(map[12]["normalised_rms"], events[0].channels[1].map.rows[2].bands[1].normalised);
  EXPECT_TRUE(map[1]["normalised_rms"].is_null());  // 2 s contain no frequency below 0.1 Hz
  EXPECT_EQ(j["adequate"], false);
}
TEST(CompareReportTest, JsonHasTheCommonPartOfAllCommands) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  const auto j = nlohmann::json::parse(json_report(example_model(), events, adequacy, fitness_of(events),
                                                   handed(events), {{"command", "swingbank compare"}}));
  EXPECT_EQ(j["format"], kReportFormat);
  EXPECT_EQ(j["kind"], "compare");
  EXPECT_EQ(j["command"], "swingbank compare");
  EXPECT_EQ(j["events"][0]["use"], "comparison");
  EXPECT_EQ(j["events"].size(), 1U);
  EXPECT_EQ(j["model"]["mva"], example_model().plant.mva);
  EXPECT_EQ(j["errors"][0]["unit"], "MW");
  EXPECT_EQ(j["usability"]["operating_points"][0]["record"], events[0].record.name);
  EXPECT_EQ(j["usability"]["usable"], true);
  EXPECT_EQ(j["nameplate"]["missing"][0], "owner");
}

TEST(EventUseTest, DistinguishesFitFromVerification) {
  const EventUse none{}, alone{true, {}}, held{true, {"b.csv"}};
  EXPECT_EQ(none.of("a.csv"), "comparison");
  EXPECT_EQ(none.sentence({"a.csv"}), "");
  EXPECT_EQ(alone.sentence({"a.csv"}),
            "Fitted to 1 event; no independent event verifies the fit (--hold-out).");
  EXPECT_EQ(held.of("a.csv") + held.of("b.csv"), "fitverification");
  EXPECT_EQ(held.sentence({"a.csv", "c.csv", "b.csv"}),
            "Fitted to 2 events; verified by the independent event b.csv.");
  std::vector<EventComparison> events = {example_event()};
  judge(events);
  const report::Table table =
      error_table({{"one", events, fitness_of(events)}}, {true, {events[0].record.name}});
  EXPECT_EQ(table.header[2], "use");
  EXPECT_EQ(table.rows[0][2].text, "verification");
}

TEST(HandedInTest, PageShowsNameplateUsabilityAndSignatures) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  plant::PlantModel model = example_model();
  model.nameplate.values = {{"owner", std::string("A & B")}, {"kv", 13.8}};
  const HandedIn in = handed_in(model, events);
  const std::string html = html_report(model, events, adequacy, fitness_of(events), in, {{"command", "x"}});
  EXPECT_THAT(html, HasSubstr("Model information</h2>"));
  EXPECT_THAT(html, HasSubstr("A &amp; B"));
  EXPECT_THAT(html, HasSubstr("13.8 kV"));
  EXPECT_THAT(html, HasSubstr("missing</td>"));
  EXPECT_THAT(html, HasSubstr("Missing under [nameplate] of " + report::escape(model.origin) +
                              ": plant, unit, mva,"));
  EXPECT_THAT(html, HasSubstr("Initialises; the step response is damped."));
  EXPECT_THAT(html, HasSubstr("<section class=\"signatures\">"));
  const auto j = nlohmann::json::parse(json_report(model, events, adequacy, fitness_of(events), in, {}));
  EXPECT_EQ(j["nameplate"]["given"], (nlohmann::json{{"owner", "A & B"}, {"kv", 13.8}}));
  EXPECT_THAT(
      handed_in_text(in),
      HasSubstr("Usability: Initialises; the step response is damped; drift in 10 s < 1e-05 % of MVA"));
}

TEST(CompareReportTest, PageLoadsNothingExternal) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  const std::string html = html_report(example_model(), events, adequacy, fitness_of(events), handed(events),
                                       provenance(example_model(), events, "swingbank compare <x>"));
  std::string own = html;
  for (const char* file : {"uPlot.iife.min.js", "uPlot.min.css"}) {
    const std::string library(report::asset(file).text);
    const auto at = own.find(library);
    ASSERT_NE(at, std::string::npos) << file;
    own.erase(at, library.size());
    EXPECT_EQ(library.find("sourceMappingURL"), std::string::npos);  // a browser would fetch it
  }
  for (const char* word : {"<link", "src=", "@import", "url(", "http:", "https:"})
    EXPECT_EQ(own.find(word), std::string::npos) << word;
  EXPECT_NE(own.find("swingbank compare &lt;x&gt;"), std::string::npos);
  EXPECT_NE(own.find("name=\"viewport\""), std::string::npos);
  ASSERT_NE(own.find("Error map</h2>"), std::string::npos);
  EXPECT_LT(own.find("class=\"headline bad\""),
            own.find("class=\"chips\""));  // verdict, chips, charts, map, events
  EXPECT_LT(own.find("class=\"chips\""), own.find("<figure id=\"event-1-Q\">"));
  EXPECT_LT(own.find("<figure id=\"event-1-Q\">"), own.find("Error map</h2>"));
  EXPECT_LT(own.find("Error map</h2>"), own.find("Events</h2>"));
  EXPECT_EQ(own.find("Hypotheses</h2>"), std::string::npos);  // compare has no hypotheses
}
TEST(CompareReportTest, FirstScreenLinksEachChannelToItsChart) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  const Fitness fitness = fitness_of(events);
  const std::string html = html_report(example_model(), events, adequacy, fitness, handed(events),
                                       {{"command", "swingbank compare --model m --out o --records r"}});
  EXPECT_THAT(html, HasSubstr("Model does not match the records"));
  EXPECT_THAT(html, HasSubstr("<code>swingbank diagnose --model m --records r</code>"));
  for (const ChannelComparison& c : events[0].channels) {
    if (!c.judged) continue;
    const std::string id = chart_id(0, c.name);
    const auto chip = html.find("href=\"#" + id + "\"");
    ASSERT_NE(chip, std::string::npos) << c.name;
    EXPECT_THAT(html.substr(chip, 600), HasSubstr("</b> " + report::times_noise(c.whole.in_noise))) << c.name;
    EXPECT_NE(html.find("<figure id=\"" + id + "\">"), std::string::npos) << c.name;
  }
  const ChannelError q = channel_error(fitness, events[0], events[0].channels[1]);
  EXPECT_EQ(q.tone, report::Tone::bad);
  EXPECT_THAT(html, HasSubstr("furthest above noise</span> <span class=\"part\">"));
}
TEST(CompareReportTest, HeadlinesHaveAtMostEightWords) {
  Fitness fit, unfit;
  fit.fit = true;
  for (const bool complete : {false, true})
    for (const auto remainder : {Remainder::noise, Remainder::uncertainty, Remainder::playback})
      for (const Fitness* f : {&fit, &unfit}) {
        const std::string text = headline(complete, *f, "Calibrated model", remainder);
        EXPECT_LE(std::ranges::count(text, ' '), 7) << text;
        EXPECT_TRUE(remainder == Remainder::noise || text.find("nly noise") == std::string::npos) << text;
      }
  EXPECT_EQ(headline(true, fit), "Model matches: only noise remains");
  EXPECT_EQ(headline(false, unfit), "Model does not match the records");
  EXPECT_EQ(headline(true, unfit), "Only noise remains, but limits are exceeded");
}
// A fit is judged by the chi-square of whole events, the error map by window and band. If the map marks a
// channel as above noise, the page must not claim that only noise remains.
TEST(CompareReportTest, PageOfAFitStatesWhyPlaybackExceedsNoise) {
  std::vector<EventComparison> events = {example_event()};
  judge(events);
  CommandPage page;
  page.complete = true;
  page.sentence = "The residual is noise.";
  page.played = {{"submitted", events, fitness_of(events)}, {"calibrated", events, fitness_of(events)}};
  for (Played& p : page.played) p.fitness.fit = true;
  EXPECT_THAT(beyond_noise(page.played.back()), testing::Contains("Q of avr_ev1.csv"));
  std::string html = command_html(page);
  EXPECT_EQ(headline_of(page), "Calibrated model matches, but playback exceeds noise");
  EXPECT_THAT(html, HasSubstr("class=\"headline warn\""));
  EXPECT_THAT(html, HasSubstr("Q of avr_ev1.csv"));
  EXPECT_THAT(html, HasSubstr("above the noise bound."));
  for (auto& channel : page.played.back().events[0].channels) {
    channel.map.whole.bound = 1e9;
    for (auto& row : channel.map.rows) {
      row.all.bound = 1e9;
      for (auto& bin : row.bands) bin.bound = 1e9;
    }
  }
  html = command_html(page);
  EXPECT_EQ(headline_of(page), "Calibrated model matches: only noise remains");
  EXPECT_THAT(html, HasSubstr("class=\"headline good\""));
  EXPECT_THAT(html, testing::Not(HasSubstr("above the noise bound.")));
  page.noise_alone = false;
  EXPECT_EQ(headline_of(page), "Calibrated model matches: noise and parameter uncertainty remain");
}
TEST(CompareReportTest, MapCellsShowPercentOfMvaAndNoise) {
  std::vector<EventComparison> events = {example_event()};
  judge(events);
  const report::Table map = map_table(maps_of(events));
  const ChannelComparison& q = events[0].channels[1];
  const TimeFrequencyBin& bin = q.map.rows[2].all;
  const std::string expected =
      fmt::format("RMS {:.3g} Mvar, {:.2g} % of {:.4g} MVA; normalised RMS {} (limit {})", bin.rms * q.scale,
                  100 * bin.rms / q.size, q.size * q.scale, report::ratio_text(bin.normalised),
                  report::ratio_text(bin.bound));
  EXPECT_EQ(std::ranges::count_if(map.rows, [&](const auto& row) { return row[3].hint.ends_with(expected); }),
            1);
}

TEST(CompareReportTest, TerminalReportHasUnits) {
  std::vector<EventComparison> events = {example_event()};
  const Adequacy adequacy = judge(events);
  const std::string text =
      terminal_report(example_model(), events, adequacy, fitness_of(events), handed(events), true);
  for (const char* word : {" MW", " Mvar", " mHz", "noise", "Not adequate", "avr_ev1.csv"})
    EXPECT_THAT(text, HasSubstr(word));
}
TEST(CompareReportTest, TerminalReport_PrintsVerdictFirstAndEachNoteOnce) {
  std::vector<EventComparison> events(2, example_event());
  events[1].record.name = "other.csv";
  for (auto& e : events) e.notes = {"a note of both"};
  events[1].notes.push_back("a note of one");
  const Adequacy adequacy = judge(events);
  const std::string text =
      terminal_report(example_model(), events, adequacy, fitness_of(events), handed(events), false);
  EXPECT_THAT(text, ::testing::StartsWith("Fit for purpose: "));
  EXPECT_THAT(text, HasSubstr("note (all events): a note of both\nnote (other.csv): a note of one\n"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("In units of noise")));
}
TEST(CompareReportTest, PlaybackHasOneLinePerSample) {
  const EventComparison e = example_event();
  const std::string text = csv_playback(e);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), e.record.samples() + 1);
}

}  // namespace
}  // namespace swingbank::validate::compare
