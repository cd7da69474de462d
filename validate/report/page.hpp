#pragma once
// One self-contained HTML page: text, tables, zoomable curves, bars and provenance. Opens offline, on a
// telephone and on paper; no resource is fetched. Every text given is escaped here.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace swingbank::validate::report {

/// & < > " as entities.
std::string escape(std::string_view text);

/// A cell's text and, if any, its shade: 0 good … 1 bad; and the address it leads to on a page.
struct Cell {
  std::string text;
  double shade = -1;
  std::string link = {};
  Cell(std::string t)
      : text(std::move(t)) {}       // NOLINT(google-explicit-constructor): a cell is mostly its text
  Cell(const char* t) : text(t) {}  // NOLINT(google-explicit-constructor)
  Cell(std::string t, double s) : text(std::move(t)), shade(s) {}
};
/// The first column is left-aligned, the others are numbers.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
};

/// Curves over a common x. Charts of the same group zoom together.
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
  double tolerance = 0;                          ///< shaded: y from -tolerance to it; 0: none
};

/// Horizontal bars with a reference line, as inline SVG; a NaN is drawn as "missing".
struct Bars {
  std::string title, unit;
  double reference = 0;  ///< position of the line, 0: none
  std::string reference_label;
  struct Bar {
    std::string label;
    double value;
    bool good = true;
    std::string shown = {};  ///< beside the bar, instead of the value
  };
  std::vector<Bar> bars;
};

/// Points in a plane, small, as inline SVG.
struct Scatter {
  std::string title, x_label, y_label;
  struct Group {
    std::string name, colour;
    std::vector<std::pair<double, double>> points;
  };
  std::vector<Group> groups;
};

enum class Tone { good, found, bad };

using Provenance = std::vector<std::pair<std::string, std::string>>;

class Page {
 public:
  Page(std::string_view title, std::string_view subtitle);
  void section(std::string_view title);
  void subsection(std::string_view title);
  void text(std::string_view paragraph);
  void note(std::string_view paragraph);               ///< set apart: a caution
  void verdict(std::string_view sentence, Tone tone);  ///< the first thing to read
  void table(const Table& table);
  void curves(const Curves& curves);
  void begin_panels();  ///< curves from here to end_panels() stand two in a row, where there is room
  void end_panels();
  void hint(std::string_view paragraph);  ///< for the screen; not printed
  void bars(const Bars& bars);
  void picture(std::string_view svg, std::string_view caption);
  void scatters(const std::vector<Scatter>& side_by_side);
  void provenance(const Provenance& rows);
  void data(std::string_view id, std::string_view json);  ///< for programs; not shown
  /// The whole page. Scripts are part of it only if it has curves.
  [[nodiscard]] std::string html() const;

 private:
  std::string title_, body_, charts_;
  int curves_ = 0;
};

/// The same table as Markdown and as CSV (RFC 4180).
std::string markdown(const Table& table);
std::string csv(const Table& table);
/// The same in columns for a terminal, as wide as their texts (characters, not bytes); the first `left`
/// columns start at the left.
std::string padded(const Table& table, std::size_t left = 2);

/// Source text of the chart library.
std::string_view dygraphs_script();
std::string_view dygraphs_style();

}  // namespace swingbank::validate::report
