#include "validate/report/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "validate/report/assets.hpp"

namespace swingbank::validate::report {
namespace {

using ::testing::HasSubstr;

/// Document with one chart whose texts are `name` and whose second value is missing.
Document with_curves(const std::string& name) {
  Document page{"a", "b"};
  Curves curves{name, "pu", name, {0, 1}};
  curves.series = {{name, Ink::measured, {1, std::nan("")}}, {"model", Ink::fitted, {3, 4}}};
  curves.id = "event-1-P";
  page.add(curves);
  return page;
}

TEST(DocumentTest, EscapesUserText) {
  Document page = with_curves("</script><script>");
  page.title = "<script>alert(1)</script>";
  page.add(Table{"<i>", {"<b>"}, {{"<u>\""}}});
  page.note("<p>");
  page.provenance({{"<k>", "<v>"}});
  page.add(Chips{{{"<e>", {{"<c>", "<r>", Tone::bad, "\"><x>", "\"<h>"}}}}});
  const std::string text = html(page);
  const std::string body = text.substr(text.find("<body>"), text.find("</main>") - text.find("<body>"));
  for (const char* raw :
       {"alert(1)<", "<i>", "<b>\"", "<u>", "<k>", "<v>", "<e>", "<c>", "<r>", "<x>", "<h>"})
    EXPECT_EQ(body.find(raw), std::string::npos) << raw;
  std::size_t closing = 0;
  for (auto at = text.find("</script>"); at != std::string::npos; at = text.find("</script>", at + 1))
    ++closing;
  EXPECT_EQ(closing, 4u);  // the chart's data, the library, and two scripts: no label closes one early
}
TEST(DocumentTest, JsonContainsNoTag) {
  Document page = with_curves("<!-- bad \xff byte");
  page.add(Data{"figures", R"({"name":"<!--<script>"})"});
  const std::string text = html(page);
  EXPECT_THAT(text, HasSubstr(R"({"name":"\u003c!--\u003cscript>"})"));
  EXPECT_THAT(text, HasSubstr("bad \xef\xbf\xbd byte"));  // invalid UTF-8 is replaced; nothing is thrown
}
TEST(DocumentTest, NestsLayouts) {
  Document page{"a", "b"};
  page.add(Begin{Begin::Layout::fold, "Event <1>"});
  page.add(Begin{Begin::Layout::panels});
  page.text("inside");
  page.add(End{});
  page.add(End{});
  EXPECT_THAT(html(page), HasSubstr("<details><summary>Event &lt;1&gt;</summary>\n<div class=\"panels\">\n"
                                    "<p>inside</p>\n</div>\n</details>\n"));
}
TEST(DocumentTest, IncludesScriptsOnlyWithCurves) {
  EXPECT_EQ(html({"a", "b"}).find("<script"), std::string::npos);
  const std::string text = html(with_curves("c"));
  EXPECT_THAT(text, HasSubstr("\"data\":[[0,1],[1,null],[3,4]]"));  // a missing value interrupts the curve
  EXPECT_THAT(text, HasSubstr("<figure id=\"event-1-P\">"));
  for (const char* file : {"uPlot.iife.min.js", "curves.js", "report.js", "shared.css", "report.css"}) {
    EXPECT_FALSE(asset(file).text.empty()) << file;
    EXPECT_NE(text.find(asset(file).text), std::string::npos) << file;
  }
}
TEST(DocumentTest, CaptionStatesTheShownPart) {
  Curves curves{"P", "MW", "event", {0, 15}};
  curves.series = {{"measured", Ink::measured, {1, 2}}};
  const auto caption = [&] {
    Document page{"a", "b"};
    page.add(curves);
    const std::string text = html(page);
    const auto begin = text.find("<figcaption>");
    return text.substr(begin, text.find("</figcaption>") - begin);
  };
  curves.view = {1, 7};
  EXPECT_THAT(caption(), HasSubstr("<span class=\"part\">t = 1 to 7 s of 0 to 15 s</span>"));
  curves.view = {0, 15};
  EXPECT_THAT(caption(), HasSubstr("<span class=\"part\"></span>"));
}
TEST(DocumentTest, SortableTableHasAScript) {
  Document page{"a", "b"};
  Table table{"", {"h"}, {{"c"}}};
  page.add(table);
  EXPECT_EQ(html(page).find("<script"), std::string::npos);
  table.sortable = true;
  page.add(table);
  const std::string text = html(page);
  EXPECT_THAT(text, HasSubstr("<table class=\"sortable\">"));
  EXPECT_FALSE(asset("table.js").text.empty());
  EXPECT_THAT(text, HasSubstr(std::string(asset("table.js").text)));
}
TEST(DocumentTest, LegendShowsMeasuredAsPoints) {
  const std::string text = html(with_curves("c"));
  EXPECT_THAT(text, HasSubstr("<span class=\"key measured\"></span>c"));
  EXPECT_THAT(text, HasSubstr("<span class=\"key model\"></span>model"));
}
TEST(DocumentTest, CellShowsShadeAndHint) {
  Document page{"a", "b"};
  Cell cell("86 × *", 0.5);
  cell.hint = "Q: 27.7 % of \"100\" MVA";
  page.add(Table{"", {"h"}, {{cell, Cell("1.0 ×", 0.0)}}});
  EXPECT_THAT(html(page), HasSubstr("<td class=\"cell\" style=\"--shade-of:0.50\" title=\"Q: 27.7 % of "
                                    "&quot;100&quot; MVA\">86 × *</td><td class=\"cell within\">1.0 ×</td>"));
}
TEST(DocumentTest, MarkdownOmitsCurvesAndTheCommand) {
  Document page = with_curves("c");
  page.section("s");
  page.add(Paragraph{"Green: good.", Paragraph::Kind::plain, false});
  page.note("n");
  page.add(Picture{"<svg/>", "p", "tables/p.svg"});
  page.provenance({{"command", "swingbank x"}, {"software", "y"}});
  EXPECT_EQ(markdown(page),
            "# a\n\nb\n\n## s\n\n> n\n\n![p](tables/p.svg)\n\n## Provenance\n\n- software: y\n");
}
TEST(DocumentTest, UnitsAreText) {
  Document page{"a", "b"};
  page.add(Table{"", {"unit", "value"}, {{"-", "0.1"}, {"1/s", "\u2013"}, {"pu", "12"}}});
  const std::string text = html(page);
  for (const char* word : {">-<", ">1/s<", ">pu<"}) {
    const auto at = text.find(word);
    ASSERT_NE(at, std::string::npos);
    EXPECT_NE(text.substr(text.rfind('<', at), at - text.rfind('<', at)).find("words"), std::string::npos)
        << word;
  }
  for (const char* value : {">0.1<", ">\u2013<", ">12<"}) {
    const auto at = text.find(value);
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(text.substr(text.rfind('<', at), at - text.rfind('<', at)).find("words"), std::string::npos)
        << value;
  }
}
TEST(DocumentTest, QuotesMarkdownAndCsv) {
  const Table table{"", {"a", "b"}, {{"x|y", "1,5"}, {"\"q\"", "2"}}};
  EXPECT_EQ(markdown(table), "| a | b |\n| --- | ---: |\n| x\\|y | 1,5 |\n| \"q\" | 2 |\n");
  EXPECT_EQ(csv(table), "a,b\nx|y,\"1,5\"\n\"\"\"q\"\"\",2\n");
}
TEST(DocumentTest, BarsLabelValuesThatAreNotFinite) {
  Document page{"a", "b"};
  page.add(Bars{"t", "", 1.0, "line", {{"one", 0.5}, {"two", std::nan("")}}});
  EXPECT_NE(html(page).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::validate::report
