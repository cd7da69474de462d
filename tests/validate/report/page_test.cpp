#include "validate/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PageTest, EscapesUserText) {
  Page page("<script>alert(1)</script>", "a & b");
  page.table({"<i>", {"<b>"}, {{"<u>\""}}});
  page.note("<p>");
  page.provenance({{"<k>", "<v>"}});
  page.curves({"<c>", "t", "</script><script>", "g", {0, 1}, {{"</script>", "red", false, {1, 2}}}, {}});
  const std::string html = page.html();
  const auto script = html.find("<script>");  // the first one is that of the chart library
  const std::string body = html.substr(0, script);
  for (const char* raw : {"alert(1)<", "<i>", "<b>", "<u>", "<k>", "<v>", "<c>"})
    EXPECT_EQ(body.find(raw), std::string::npos) << raw;
  std::size_t closing = 0;
  for (auto at = html.find("</script>"); at != std::string::npos; at = html.find("</script>", at + 1))
    ++closing;
  EXPECT_EQ(closing, 2u);  // the library's and the page's: no label closes one early
}
TEST(PageTest, JsonContainsNoTag) {
  Page page("a", "b");
  page.data("figures", R"({"name":"<!--<script>"})");
  page.curves({"c", "t", "y", "<!--", {0, 1}, {{"bad \xff byte", "red", false, {1, 2}}}, {}});
  const std::string html = page.html();
  EXPECT_THAT(html, HasSubstr(R"({"name":"\u003c!--\u003cscript>"})"));
  EXPECT_THAT(html, HasSubstr("bad \xef\xbf\xbd byte"));  // invalid UTF-8 is replaced; nothing is thrown
}
TEST(PageTest, ArrangesPanelsInAGrid) {
  Page page("a", "b");
  page.begin_panels();
  page.curves({"c", "t", "y", "g", {0, 1}, {{"s", "red", false, {1, 2}}}, {}});
  page.end_panels();
  EXPECT_LT(page.html().find("class=\"panels\""), page.html().find("<figure>"));
}
TEST(PageTest, IncludesScriptsOnlyWithCurves) {
  Page page("a", "b");
  EXPECT_EQ(page.html().find("<script"), std::string::npos);
  page.curves({"c", "t", "y", "g", {0, 1}, {{"s", "red", false, {1, std::nan("")}}}, {}});
  EXPECT_NE(page.html().find("[1,null]"), std::string::npos);  // a value that is not finite gives a gap
  EXPECT_GT(dygraphs_script().size(), 100'000u);
}
TEST(PageTest, UnitsAreText) {
  Page page("a", "b");
  page.table({"", {"unit", "value"}, {{"-", "0.1"}, {"1/s", "\u2013"}, {"pu", "12"}}});
  const std::string html = page.html();
  for (const char* word : {">-<", ">1/s<", ">pu<"}) {
    const auto at = html.find(word);
    ASSERT_NE(at, std::string::npos);
    EXPECT_NE(html.substr(html.rfind('<', at), at - html.rfind('<', at)).find("words"), std::string::npos)
        << word;
  }
  for (const char* value : {">0.1<", ">\u2013<", ">12<"}) {
    const auto at = html.find(value);
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(html.substr(html.rfind('<', at), at - html.rfind('<', at)).find("words"), std::string::npos)
        << value;
  }
}
TEST(PageTest, QuotesMarkdownAndCsv) {
  const Table table{"", {"a", "b"}, {{"x|y", "1,5"}, {"\"q\"", "2"}}};
  EXPECT_EQ(markdown(table), "| a | b |\n| --- | ---: |\n| x\\|y | 1,5 |\n| \"q\" | 2 |\n");
  EXPECT_EQ(csv(table), "a,b\nx|y,\"1,5\"\n\"\"\"q\"\"\",2\n");
}
TEST(PageTest, BarsLabelMissingValues) {
  Page page("a", "b");
  page.bars({"t", "", 1.0, "line", {{"one", 0.5}, {"two", std::nan("")}}});
  EXPECT_NE(page.html().find("missing"), std::string::npos);
}

}  // namespace
}  // namespace swingbank::validate::report
