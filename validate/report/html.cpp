// Rendering of a document as a self-contained HTML page.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/json.hpp"
#include "validate/report/assets.hpp"
#include "validate/report/detail/figures.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::report {
namespace {

/// Escapes JSON for a <script>, so that no tag or comment can begin in it.
std::string script_safe(std::string text) {
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6)
    text.replace(at, 1, "\\u003c");
  return text;
}

/// Returns whether a cell holds text, which is left-aligned, and not a number. The units "-" and "1/s" are
/// text; a missing number ("–") is a number.
bool is_words(const Cell& cell) {
  if (cell.shade >= 0 || cell.text.empty()) return false;
  const auto after = cell.text.find_first_not_of("0123456789.");
  return cell.text == "-" || std::isalpha(static_cast<unsigned char>(cell.text.front())) != 0 ||
         (after > 0 && after != std::string::npos && cell.text[after] == '/');
}
std::string cell_attributes(const Cell& cell) {
  std::string text = is_words(cell) ? " class=\"words\"" : "";
  if (cell.shade == 0)
    text = " class=\"cell within\"";
  else if (cell.shade > 0)
    text = fmt::format(" class=\"cell\" style=\"--shade-of:{:.2f}\"", std::min(cell.shade, 1.0));
  if (!cell.id.empty()) text += fmt::format(" id=\"{}\"", escape(cell.id));
  return cell.hint.empty() ? text : text + fmt::format(" title=\"{}\"", escape(cell.hint));
}

std::string linked(const std::string& text, const std::string& link) {
  return link.empty() ? escape(text) : fmt::format("<a href=\"{}\">{}</a>", escape(link), escape(text));
}

/// Formats six significant digits, which is more than a screen resolves and a third of the full length.
std::string number(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : "null"; }
std::string column(const std::vector<double>& values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "[" : ",") + number(v);
  return text.empty() ? "[]" : text + "]";
}
/// Returns the time range that a chart shows at first: "t = 1 to 7 s of 0 to 15 s"; empty if it shows all
/// times. report.js updates it when the reader zooms.
std::string shown_part(const Curves& c) {
  if (!c.view || c.x.empty() || (c.view->first <= c.x.front() && c.view->second >= c.x.back())) return {};
  const double rounding = 1e-9 * (c.x.back() - c.x.front());  // rounding error of shifted times
  const double begin = std::abs(c.x.front()) < rounding ? 0.0 : c.x.front();
  return fmt::format("t = {:.4g} to {:.4g} s of {:.4g} to {:.4g} s", c.view->first, c.view->second, begin,
                     c.x.back());
}
const char* tone_class(Tone tone) {
  return tone == Tone::good ? "good" : tone == Tone::warn ? "warn" : tone == Tone::bad ? "bad" : "found";
}

/// Renders the blocks one after another.
class Renderer {
 public:
  void operator()(const Heading& h) { body += fmt::format("<h{0}>{1}</h{0}>\n", h.level, escape(h.text)); }
  void operator()(const Paragraph& p) {
    static constexpr std::array kClass = {"", " class=\"note\"", " class=\"hint\"", " class=\"command\""};
    const bool command = p.kind == Paragraph::Kind::command;
    body += fmt::format("<p{}>{}{}{}</p>\n", kClass.at(static_cast<std::size_t>(p.kind)),
                        command ? "Next: <code>" : "", linked(p.text, p.link), command ? "</code>" : "");
  }
  void operator()(const Opening& a) {
    body += fmt::format("<p class=\"headline {}\">{}</p>\n", tone_class(a.tone), escape(a.headline));
    for (const auto& reason : a.reasons) body += fmt::format("<p class=\"reason\">{}</p>\n", escape(reason));
  }
  void operator()(const Verdict& v) {
    body += fmt::format("<p class=\"verdict {}\">{}</p>\n", tone_class(v.tone), escape(v.sentence));
  }
  void operator()(const Chips& chips) {
    static constexpr std::array kSign = {"✓", "!", "✕", ""};
    body += "<nav class=\"chips\" aria-label=\"Events and channels\">\n";
    for (const auto& group : chips.groups) {
      body += fmt::format("<span><span>{}</span>", escape(group.name));
      for (const auto& c : group.chips)
        body += fmt::format(" <a class=\"chip {}\" href=\"#{}\" title=\"{}\">{} <b>{}</b> {}</a>",
                            tone_class(c.tone), escape(c.link), escape(c.hint),
                            kSign.at(static_cast<std::size_t>(c.tone)), escape(c.name), escape(c.value));
      body += "</span>\n";
    }
    body += "</nav>\n";
  }
  void operator()(const Table& table) {
    sortable += table.sortable;
    body += fmt::format("<div class=\"scroll\"><table{}>", table.heat       ? " class=\"heat\""
                                                           : table.sortable ? " class=\"sortable\""
                                                                            : "");
    if (!table.caption.empty()) body += fmt::format("<caption>{}</caption>", escape(table.caption));
    body += "<thead><tr>";
    for (std::size_t i = 0; i < table.header.size(); ++i) {
      const bool words =
          !table.rows.empty() && i < table.rows.front().size() && is_words(table.rows.front()[i]);
      body += fmt::format("<th{}>{}</th>", words ? " class=\"words\"" : "", escape(table.header[i]));
    }
    body += "</tr></thead><tbody>\n";
    for (const auto& row : table.rows) {
      body += "<tr>";
      for (const auto& cell : row)
        body += fmt::format("<td{}>{}</td>", cell_attributes(cell), linked(cell.text, cell.link));
      body += "</tr>\n";
    }
    body += "</tbody></table></div>\n";
  }
  void operator()(const Curves& c) {
    ++charts;
    nlohmann::json of = {{"unit", c.unit}, {"group", c.group}, {"tolerance", c.tolerance}};
    const auto interval = [&](const char* name, const std::optional<std::pair<double, double>>& ends) {
      if (ends) of[name] = {ends->first, ends->second};
    };
    interval("fault", c.fault);
    interval("window", c.window);
    interval("view", c.view);
    of["series"] = nlohmann::json::array();
    std::string legend, columns = column(c.x);
    for (const auto& s : c.series) {
      of["series"].push_back({{"name", s.name}, {"ink", ink_name(s.ink)}});
      legend += fmt::format(" <span class=\"entry\"><span class=\"key {}\"></span>{}</span>", ink_name(s.ink),
                            escape(s.name));
      columns += "," + column(s.y);
    }
    std::string text = script_safe(json_text(of));
    text.back() = ',';
    body += fmt::format(
        "<figure{}><figcaption><b>{}</b> [{}] {}{} <span class=\"part\">{}</span></figcaption><div class=\"chart\" role=\"img\" "
        "aria-label=\"{}\"><script type=\"application/json\">{}\"data\":[{}]}}</script></div></figure>\n",
        c.id.empty() ? "" : fmt::format(" id=\"{}\"", escape(c.id)), escape(c.title), escape(c.unit), legend,
        c.window ? " <span class=\"entry\"><span class=\"key window\"></span>furthest above noise</span>"
                 : "",
        shown_part(c), escape(c.title), text, columns);
  }
  void operator()(const Bars& b) {
    body += fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n", escape(b.title), bars_svg(b));
  }
  void operator()(const Scatter& s) {
    body +=
        fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n", scatter_legend(s), scatter_svg(s));
  }
  void operator()(const Picture& p) {
    if (!p.svg.empty())
      body += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", p.svg, escape(p.caption));
  }
  void operator()(const Facts& facts) {
    body += "<table class=\"facts\"><tbody>\n";
    for (const auto& [name, value] : facts.rows)
      body += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape(name), escape(value));
    body += "</tbody></table>\n";
  }
  void operator()(const Data& d) {
    body += fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", escape(d.id),
                        script_safe(d.json));
  }
  void operator()(const Signatures& s) {
    body +=
        "<section class=\"signatures\"><h2>Signatures</h2><table><thead><tr><th></th><th>Name</th><th>Date</th>"
        "<th>Signature</th></tr></thead><tbody>\n";
    for (const auto& role : s.roles)
      body += fmt::format("<tr><th>{}</th><td></td><td></td><td></td></tr>\n", escape(role));
    body += "</tbody></table></section>\n";
  }
  void operator()(const Begin& b) {
    const bool fold = b.layout == Begin::Layout::fold;
    ends_.push_back(fold ? "</details>\n" : "</div>\n");
    body += fold ? fmt::format("<details><summary>{}</summary>\n", escape(b.title))
                 : fmt::format("<div class=\"{}\">\n", b.layout == Begin::Layout::large    ? "large"
                                                       : b.layout == Begin::Layout::panels ? "panels"
                                                                                           : "side");
  }
  void operator()(const End&) {
    body += ends_.back();
    ends_.pop_back();
  }

  std::string body;
  int charts = 0, sortable = 0;

 private:
  std::vector<const char*> ends_;
};

}  // namespace

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string html(const Document& document) {
  Renderer renderer;
  for (const Block& block : document.blocks) std::visit(renderer, block);
  const std::string title = escape(document.title);
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>" +
      title + "</title>\n<style>";
  if (renderer.charts > 0) out += asset("uPlot.min.css").text;
  out += asset("shared.css").text;
  out += asset("report.css").text;
  out += fmt::format("</style></head><body><main>\n<h1>{}</h1>\n<p class=\"subtitle\">{}</p>\n{}</main>\n",
                     title, escape(document.subtitle), renderer.body);
  if (renderer.charts > 0)
    for (const char* script : {"uPlot.iife.min.js", "curves.js", "report.js"})
      out += "<script>\n" + std::string(asset(script).text) + "</script>\n";
  if (renderer.sortable > 0) out += "<script>\n" + std::string(asset("table.js").text) + "</script>\n";
  return out + "</body></html>\n";
}

}  // namespace swingbank::validate::report
