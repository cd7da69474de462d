#pragma once
// Self-contained HTML page with text, tables, zoomable curves, bars and provenance. It works offline, on
// telephones and in print, and fetches no resource. All text arguments are escaped here.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

/// Returns the text with & < > " as entities.
std::string escape(std::string_view text);

/// Table cell: text, shade from 0 (good) to 1 (bad) or none (-1), and optional link target.
struct Cell {
  std::string text;
  double shade = -1;
  std::string link = {};
  Cell(std::string t)
      : text(std::move(t)) {}       // NOLINT(google-explicit-constructor): a cell is mostly its text
  Cell(const char* t) : text(t) {}  // NOLINT(google-explicit-constructor)
  Cell(std::string t, double s) : text(std::move(t)), shade(s) {}
};
/// Table. On a page, text is left-aligned and numbers are right-aligned.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
};

/// Chart of curves over a common x. Charts of the same group zoom together.
struct Curves {
  std::string title, x_label, y_label, group;
  struct Series {
    std::string name, colour;
    bool points = false;  ///< drawn as points (measured) instead of a line (modelled)
    std::vector<double> y;
  };
  std::vector<double> x;
  std::vector<Series> series;
  std::vector<std::pair<double, double>> bands;  ///< shaded intervals of x
  double tolerance = 0;                          ///< shaded band y = -tolerance ... tolerance; 0: none
};

/// Horizontal bar chart with a reference line, as inline SVG; NaN is shown as "missing".
struct Bars {
  std::string title, unit;
  double reference = 0;  ///< position of the line, 0: none
  std::string reference_label;
  struct Bar {
    std::string label;
    double value;
    bool good = true;
    std::string shown = {};  ///< text beside the bar in place of the value
  };
  std::vector<Bar> bars;
};

/// Small scatter plot, as inline SVG.
struct Scatter {
  std::string title, x_label, y_label;
  struct Group {
    std::string name, colour;
    std::vector<std::pair<double, double>> points;
  };
  std::vector<Group> groups;
};

/// Colour of a verdict.
enum class Tone { good, found, bad };

using Provenance = std::vector<std::pair<std::string, std::string>>;

class Page {
 public:
  Page(std::string_view title, std::string_view subtitle);
  void section(std::string_view title);
  void subsection(std::string_view title);
  void text(std::string_view paragraph);
  void note(std::string_view paragraph);               ///< highlighted caution
  void verdict(std::string_view sentence, Tone tone);  ///< highlighted verdict
  void table(const Table& table);
  void curves(const Curves& curves);
  void begin_panels();  ///< curves up to end_panels() are placed two per row on wide screens
  void end_panels();
  void hint(std::string_view paragraph);  ///< shown on screen only, not printed
  void bars(const Bars& bars);
  void picture(std::string_view svg, std::string_view caption);
  void scatters(const std::vector<Scatter>& side_by_side);
  void provenance(const Provenance& rows);
  void data(std::string_view id, std::string_view json);  ///< machine-readable data; not shown
  /// Returns the whole page. It contains chart scripts only if it has curves.
  [[nodiscard]] std::string html() const;

 private:
  std::string title_, body_, charts_;
  int curves_ = 0;
};

/// Table as Markdown and as CSV (RFC 4180).
std::string markdown(const Table& table);
std::string csv(const Table& table);
/// Table as terminal text. Column widths count characters, not bytes; the first `left` columns are
/// left-aligned.
std::string padded(const Table& table, std::size_t left = 2);

/// Source text of the chart library.
std::string_view dygraphs_script();
std::string_view dygraphs_style();

}  // namespace swingbank::validate::report
