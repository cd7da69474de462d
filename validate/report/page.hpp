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
  std::string text;       ///< content without markup
  double shade = -1;      ///< 0 (good) to 1 (bad); -1: none
  std::string link = {};  ///< target of a link; empty: none
  /// Constructs a cell without shade.
  Cell(std::string t)
      : text(std::move(t)) {}  // NOLINT(google-explicit-constructor): a cell is mostly its text
  /// Constructs a cell without shade.
  Cell(const char* t) : text(t) {}  // NOLINT(google-explicit-constructor)
  /// Constructs a cell with a shade from 0 (good) to 1 (bad).
  Cell(std::string t, double s) : text(std::move(t)), shade(s) {}
};
/// Table. On a page, text is left-aligned and numbers are right-aligned.
struct Table {
  std::string caption;                  ///< caption above the table; empty: none
  std::vector<std::string> header;      ///< headings of the columns
  std::vector<std::vector<Cell>> rows;  ///< [row][column]
};

/// Chart of curves over a common x. Charts of the same group zoom together.
struct Curves {
  std::string title, x_label, y_label, group;  ///< title; axis labels with units; group that zooms together
  /// One curve.
  struct Series {
    std::string name, colour;  ///< name in the legend; CSS colour
    bool points = false;       ///< drawn as points (measured) instead of a line (modelled)
    std::vector<double> y;     ///< values at `x`; NaN interrupts the curve
  };
  std::vector<double> x;                         ///< common abscissa, ascending
  std::vector<Series> series;                    ///< curves, drawn in this order
  std::vector<std::pair<double, double>> bands;  ///< shaded intervals of x
  double tolerance = 0;                          ///< shaded band y = -tolerance ... tolerance; 0: none
};

/// Horizontal bar chart with a reference line, as inline SVG; NaN is shown as "missing".
struct Bars {
  std::string title, unit;      ///< title; unit of the values
  double reference = 0;         ///< position of the line, 0: none
  std::string reference_label;  ///< label of the reference line
  /// One bar.
  struct Bar {
    std::string label;       ///< label to the left
    double value;            ///< length of the bar [unit]; NaN: missing
    bool good = true;        ///< colour: good or bad
    std::string shown = {};  ///< text beside the bar in place of the value
  };
  std::vector<Bar> bars;  ///< bars from the top
};

/// Small scatter plot, as inline SVG.
struct Scatter {
  std::string title, x_label, y_label;  ///< title; axis labels with units
  /// Points of one colour.
  struct Group {
    std::string name, colour;                       ///< name in the legend; CSS colour
    std::vector<std::pair<double, double>> points;  ///< x and y of each point
  };
  std::vector<Group> groups;  ///< groups of points
};

/// Colour of a verdict.
enum class Tone { good, found, bad };

/// Origin of a page's figures: name and value of each line.
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// Self-contained HTML page, built from top to bottom. Texts are escaped; SVG is not.
class Page {
 public:
  /// Begins a page with its title and a line below it.
  Page(std::string_view title, std::string_view subtitle);
  /// Adds a heading of the first level.
  void section(std::string_view title);
  /// Adds a heading of the second level.
  void subsection(std::string_view title);
  /// Adds a paragraph.
  void text(std::string_view paragraph);
  void note(std::string_view paragraph);               ///< highlighted caution
  void verdict(std::string_view sentence, Tone tone);  ///< highlighted verdict
  /// Adds a table.
  void table(const Table& table);
  /// Adds a chart of curves.
  void curves(const Curves& curves);
  void begin_panels();  ///< curves up to end_panels() are placed two per row on wide screens
  /// Ends the panels.
  void end_panels();
  void hint(std::string_view paragraph);  ///< shown on screen only, not printed
  /// Adds a bar chart.
  void bars(const Bars& bars);
  /// Adds a picture, given as SVG, with its caption.
  void picture(std::string_view svg, std::string_view caption);
  /// Adds scatter plots in one row.
  void scatters(const std::vector<Scatter>& side_by_side);
  /// Adds a section "Provenance" with names and values.
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
/// Returns the table as CSV.
std::string csv(const Table& table);
/// Table as terminal text. Column widths count characters, not bytes; the first `left` columns are
/// left-aligned.
std::string padded(const Table& table, std::size_t left = 2);

/// Source text of the chart library.
std::string_view dygraphs_script();
/// Style sheet of the chart library.
std::string_view dygraphs_style();

}  // namespace swingbank::validate::report
