#include "validate/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/json.hpp"

namespace swingbank::validate::report {
namespace {

constexpr std::string_view kStyle = R"css(
:root{--ink:#1b2733;--soft:#5b6b7b;--line:#d9e0e7;--paper:#fff;--tint:#f4f7fa;--accent:#0b5cad}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:1080px;margin:0 auto;padding:24px 20px 60px}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .2rem}
h2{font-size:1.2rem;margin:2.4rem 0 .6rem;padding-top:.8rem;border-top:1px solid var(--line);overflow-wrap:anywhere}
h3{font-size:1.05rem;margin:2rem 0 .4rem;overflow-wrap:anywhere}
.subtitle{color:var(--soft);margin:0 0 1.2rem}
p{max-width:75ch;margin:.5rem 0}
.note{border-left:4px solid #c77700;background:#fff8ec;padding:.5rem .8rem}
.verdict{border-left:6px solid #c0392b;background:#fdf0ee;padding:.8rem 1rem;font-size:1.1rem;max-width:none}
.verdict.good{border-color:#2e8b57;background:#eef8f1}.verdict.found{border-color:#0b5cad;background:#eef4fb}
figure{margin:1rem 0}
figcaption,.caption{color:var(--soft);font-size:.88rem;padding:.2rem 0 .4rem;margin:1rem 0 0;break-after:avoid}
.scroll{overflow-x:auto}
table{border-collapse:separate;border-spacing:0;font-size:.9rem;font-variant-numeric:tabular-nums;min-width:min(100%,420px)}
th,td{padding:.32rem .7rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{background:var(--tint);font-weight:600;vertical-align:bottom;white-space:normal;overflow-wrap:break-word;max-width:9.5rem}
th:first-child,td:first-child{text-align:left;position:sticky;left:0}
td:first-child{background:var(--paper)}
th.words{text-align:left}
td.words{text-align:left;white-space:normal;min-width:9ch;max-width:44ch;overflow-wrap:break-word}
.wrap td{white-space:normal;overflow-wrap:anywhere;text-align:left}
.wrap td:first-child{white-space:nowrap;vertical-align:top}
.panels{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:0 18px}.panels figure{margin:.4rem 0;min-width:0}.panels .chart{height:210px}
.chart{width:100%;height:250px}
.legend{font-size:.85rem;color:var(--soft);min-height:1.4em}
.hint{color:var(--soft);font-size:.85rem}
svg{max-width:100%;height:auto;font:12px system-ui,"DejaVu Sans",sans-serif}
.dygraph-axis-label{color:var(--soft);font-size:12px}.dygraph-label{font-size:12px;color:var(--soft)}
@media(max-width:600px){table{font-size:.72rem;min-width:0}td.cell{white-space:normal}td.words{min-width:0}.panels{grid-template-columns:minmax(0,1fr)}main{padding:14px 12px 40px}h1{font-size:1.35rem}th,td{padding:.26rem .26rem}.chart{height:210px}}
@media print{main{max-width:none;padding:0}figure,p,tr,table:not(:has(tr:nth-child(25))){break-inside:avoid}h2,h3{break-after:avoid}.hint{display:none}.scroll{overflow:visible}table{font-size:8pt;min-width:0;max-width:100%}th,td{padding:.15rem .25rem;white-space:normal;position:static}th.words{text-align:left}
td.words{min-width:0}body{font-size:10pt}.panels{grid-template-columns:repeat(2,minmax(0,1fr))}.panels figcaption,.panels .legend{font-size:8pt}.cell,th,.note,.verdict{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)css";

constexpr std::string_view kScript = R"js(
const groups={};
function chart(d){
  const box=document.getElementById(d.id),group=groups[d.group]=groups[d.group]||[];
  const bounds=d.rows.length?[d.rows[0][0],d.rows[d.rows.length-1][0]]:null;
  const series={};
  d.names.forEach((n,i)=>series[n]=d.points[i]?{strokeWidth:0,drawPoints:true,pointSize:1.8}:{strokeWidth:1.6});
  let busy=false;
  const g=new Dygraph(box,d.rows,{labels:["t"].concat(d.names),colors:d.colours,series:series,xlabel:d.x,ylabel:d.y,
    legend:"always",labelsDiv:document.getElementById(d.id+"-legend"),animatedZooms:false,axisLabelWidth:52,
    digitsAfterDecimal:5,highlightCircleSize:3,xRangePad:2,yRangePad:8,
    axes:{x:{axisLabelWidth:44}},
    underlayCallback:(c,a,gr)=>{if(d.tolerance){c.fillStyle="rgba(46,139,87,.18)";const u=gr.toDomYCoord(d.tolerance);c.fillRect(a.x,u,a.w,Math.max(gr.toDomYCoord(-d.tolerance)-u,1))}
      c.fillStyle="rgba(200,60,40,.13)";d.bands.forEach(b=>{const l=gr.toDomXCoord(b[0]),r=gr.toDomXCoord(b[1]);c.fillRect(l,a.y,Math.max(r-l,1),a.h)})},
    drawCallback:(gr,first)=>{if(first||busy)return;busy=true;const w=gr.isZoomed("x")?gr.xAxisRange():null;
      group.forEach(o=>{if(o!==gr){const s=o.xAxisRange(),f=w||bounds;if(Math.abs(s[0]-f[0])+Math.abs(s[1]-f[1])>1e-9)o.updateOptions({dateWindow:w})}});busy=false}});
  group.push(g);
}
charts.forEach(chart);
// Shrunk, not redrawn: a canvas drawn while printing makes a document of 100 MB.
const boxes=[...document.querySelectorAll(".chart")];
addEventListener("beforeprint",()=>boxes.forEach(b=>{b.style.zoom=Math.min(1,(b.closest(".panels")?330:680)/b.clientWidth)}));
addEventListener("afterprint",()=>boxes.forEach(b=>{b.style.zoom=""}));
)js";

/// Escapes JSON for a <script>, so that no tag or comment can begin in it.
std::string script_safe(std::string text) {
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6)
    text.replace(at, 1, "\\u003c");
  return text;
}

std::string shade_style(double shade) {
  if (!(shade >= 0)) return {};
  const double s = std::clamp(shade, 0.0, 1.0);  // green over yellow to red, pale enough for black text
  return fmt::format(" class=\"cell\" style=\"background:hsl({:.0f} 75% {:.0f}%)\"", 125 - 125 * s,
                     90 - 10 * s);
}

/// Returns whether a cell holds text, which is left-aligned, and not a number. The units "-" and "1/s" are
/// text; a missing number ("–") is a number.
bool is_words(const Cell& cell) {
  if (cell.shade >= 0 || cell.text.empty()) return false;
  const auto after = cell.text.find_first_not_of("0123456789.");
  return cell.text == "-" || std::isalpha(static_cast<unsigned char>(cell.text.front())) != 0 ||
         (after > 0 && after != std::string::npos && cell.text[after] == '/');
}

/// Formats six significant digits: more than a screen resolves, and a third of the full size.
std::string number(double v) { return std::isfinite(v) ? fmt::format("{:.6g}", v) : "null"; }

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

Page::Page(std::string_view title, std::string_view subtitle) : title_(escape(title)) {
  body_ = fmt::format("<h1>{}</h1>\n<p class=\"subtitle\">{}</p>\n", title_, escape(subtitle));
}
void Page::section(std::string_view title) { body_ += fmt::format("<h2>{}</h2>\n", escape(title)); }
void Page::text(std::string_view paragraph) { body_ += fmt::format("<p>{}</p>\n", escape(paragraph)); }
void Page::note(std::string_view paragraph) {
  body_ += fmt::format("<p class=\"note\">{}</p>\n", escape(paragraph));
}
void Page::subsection(std::string_view title) { body_ += fmt::format("<h3>{}</h3>\n", escape(title)); }
void Page::verdict(std::string_view sentence, Tone tone) {
  const char* name = tone == Tone::good ? "good" : tone == Tone::found ? "found" : "bad";
  body_ += fmt::format("<p class=\"verdict {}\">{}</p>\n", name, escape(sentence));
}
void Page::data(std::string_view id, std::string_view json) {
  body_ += fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", escape(id),
                       script_safe(std::string(json)));
}

void Page::table(const Table& table) {
  if (!table.caption.empty()) body_ += fmt::format("<p class=\"caption\">{}</p>\n", escape(table.caption));
  body_ += "<div class=\"scroll\"><table><thead><tr>";
  for (std::size_t i = 0; i < table.header.size(); ++i)
    body_ +=
        fmt::format("<th{}>{}</th>",
                    !table.rows.empty() && i < table.rows.front().size() && is_words(table.rows.front()[i])
                        ? " class=\"words\""
                        : "",
                    escape(table.header[i]));
  body_ += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    body_ += "<tr>";
    for (const auto& cell : row)
      body_ += fmt::format("<td{}>{}</td>", is_words(cell) ? " class=\"words\"" : shade_style(cell.shade),
                           cell.link.empty()
                               ? escape(cell.text)
                               : fmt::format("<a href=\"{}\">{}</a>", escape(cell.link), escape(cell.text)));
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::curves(const Curves& c) {
  const std::string id = fmt::format("chart{}", curves_++);
  body_ += fmt::format(
      "<figure><figcaption>{}</figcaption><div class=\"legend\" id=\"{}-legend\"></div><div class=\"chart\" "
      "id=\"{}\" role=\"img\" "
      "aria-label=\"{}\"></div></figure>\n",
      escape(c.title), id, id, escape(c.title));
  nlohmann::json meta = {
      {"id", id}, {"x", c.x_label}, {"y", c.y_label}, {"group", c.group}, {"tolerance", c.tolerance}};
  meta["names"] = meta["points"] = meta["colours"] = meta["bands"] = nlohmann::json::array();
  for (const auto& s : c.series) {
    meta["names"].push_back(s.name);
    meta["points"].push_back(s.points);
    meta["colours"].push_back(s.colour);
  }
  for (const auto& [a, b] : c.bands) meta["bands"].push_back({a, b});
  std::string rows;
  for (std::size_t k = 0; k < c.x.size(); ++k) {
    rows += (k ? ",[" : "[") + number(c.x[k]);
    for (const auto& s : c.series) rows += "," + number(s.y[k]);
    rows += "]";
  }
  std::string head = script_safe(json_text(meta));
  head.back() = ',';
  charts_ += head + "\"rows\":[" + rows + "]},\n";
}

void Page::begin_panels() { body_ += "<div class=\"panels\">\n"; }
void Page::end_panels() { body_ += "</div>\n"; }
void Page::hint(std::string_view paragraph) {
  body_ += fmt::format("<p class=\"hint\">{}</p>\n", escape(paragraph));
}

void Page::bars(const Bars& b) {
  constexpr double width = 330, line = 24, top = 30;
  std::size_t longest = 0;
  for (const auto& bar : b.bars) longest = std::max(longest, bar.label.size());
  const double left = std::max(70.0, 12 + 7.8 * static_cast<double>(longest));
  double largest = b.reference * 1.1;
  for (const auto& bar : b.bars)
    if (std::isfinite(bar.value)) largest = std::max(largest, bar.value * 1.02);
  if (!(largest > 0)) largest = 1;
  const double height = top + line * static_cast<double>(b.bars.size()) + 8;
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"620\" role=\"img\" aria-label=\"{}\">",
                  left + width + 70, height, escape(b.title));
  double y = top;
  for (const auto& bar : b.bars) {
    const double w = std::isfinite(bar.value) ? std::max(width * bar.value / largest, 1.0) : 0;
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\" fill=\"#1b2733\">{}</text>",
                       left - 8, y + 17, escape(bar.label));
    svg += fmt::format(
        "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.0f}\" rx=\"2\" fill=\"{}\"/>", left,
        y + 4, w, line - 8, bar.good ? "#2f7fc1" : "#c0563f");
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" fill=\"#5b6b7b\">{}</text>", left + w + 6, y + 17,
                       !bar.shown.empty() ? escape(bar.shown)
                       : std::isfinite(bar.value)
                           ? fmt::format("{:.3g}{}", bar.value, b.unit.empty() ? "" : " " + escape(b.unit))
                           : "missing");
    y += line;
  }
  if (b.reference > 0) {
    const double x = left + width * b.reference / largest;
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.0f}\" y2=\"{2:.0f}\" stroke=\"#1b2733\" "
        "stroke-dasharray=\"4 3\"/>",
        x, top - 6, height - 4);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"end\" fill=\"#1b2733\">{}</text>",
                       x + 4, top - 12, escape(b.reference_label));
  }
  body_ += fmt::format("<figure><figcaption>{}</figcaption>{}</svg></figure>\n", escape(b.title), svg);
}

void Page::picture(std::string_view svg, std::string_view caption) {
  body_ += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg, escape(caption));
}

void Page::provenance(const Provenance& rows) {
  section("Provenance");
  body_ += "<div class=\"wrap\"><table><tbody>\n";
  for (const auto& [name, value] : rows)
    body_ += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape(name), escape(value));
  body_ += "</tbody></table></div>\n";
}

std::string Page::html() const {
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>";
  out += title_ + "</title>\n<style>" + std::string(kStyle);
  if (curves_ > 0) out += dygraphs_style();
  out += "</style></head><body><main>\n" + body_ + "</main>\n";
  if (curves_ > 0) {
    out += "<script>";
    out += dygraphs_script();
    out += "</script>\n<script>\nconst charts=[\n" + charts_ + "];\n" + std::string(kScript) + "</script>\n";
  }
  return out + "</body></html>\n";
}

std::string markdown(const Table& table) {
  const auto clean = [](std::string s) {
    for (std::size_t at = 0; (at = s.find('|', at)) != std::string::npos; at += 2) s.insert(at, "\\");
    return s;
  };
  std::string out = table.caption.empty() ? "" : table.caption + "\n\n";
  out += "|";
  for (const auto& h : table.header) out += " " + clean(h) + " |";
  out += "\n|";
  for (std::size_t i = 0; i < table.header.size(); ++i) out += i == 0 ? " --- |" : " ---: |";
  for (const auto& row : table.rows) {
    out += "\n|";
    for (const auto& cell : row) out += " " + clean(cell.text) + " |";
  }
  return out + "\n";
}

std::string csv(const Table& table) {
  const auto quoted = [](const std::string& s) {
    if (s.find_first_of(",\"\n") == std::string::npos) return s;
    std::string r = "\"";
    for (const char c : s) r += c == '"' ? "\"\"" : std::string(1, c);
    return r + "\"";
  };
  std::string out;
  const auto line = [&](const auto& cells, const auto& text) {
    for (std::size_t i = 0; i < cells.size(); ++i) out += (i ? "," : "") + quoted(text(cells[i]));
    out += "\n";
  };
  line(table.header, [](const std::string& s) { return s; });
  for (const auto& row : table.rows) line(row, [](const Cell& c) { return c.text; });
  return out;
}

std::string padded(const Table& table, std::size_t left) {
  const auto length = [](const std::string& s) {
    return std::ranges::count_if(s, [](unsigned char c) { return (c & 0xC0) != 0x80; });
  };
  std::vector<std::ptrdiff_t> width;
  for (const auto& h : table.header) width.push_back(length(h));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], length(row[i].text));
  std::string out;
  const auto line = [&](const auto& row, const auto& text) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string pad(static_cast<std::size_t>(width[i] - length(text(row[i]))), ' ');
      out += i < left ? text(row[i]) + pad + "  " : pad + text(row[i]) + "  ";
    }
    out.erase(out.find_last_not_of(' ') + 1);
    out += "\n";
  };
  line(table.header, [](const std::string& s) { return s; });
  for (const auto& row : table.rows) line(row, [](const Cell& c) { return c.text; });
  return out;
}

}  // namespace swingbank::validate::report
