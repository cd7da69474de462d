#pragma once
// Document of a report: verdict, sections, tables and figures. It is built once, and rendered as a page or as
// text.
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace swingbank::validate::report {

/// Colour of a verdict.
enum class Tone { good, warn, bad, found };

/// Table cell: text, shade from 0 (good) to 1 (bad) or none (-1), and optional link target.
struct Cell {
  std::string text;       ///< content without markup
  double shade = -1;      ///< 0 (good) to 1 (bad); -1: none
  std::string link = {};  ///< target of a link; empty: none
  std::string hint = {};  ///< shown while the pointer is on the cell; empty: none
  std::string id = {};    ///< target of links; empty: none
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
  bool heat = false;                    ///< narrow cells, for a heat map
  bool sortable = false;                ///< a script lets the reader sort by a column and filter the rows
};

/// Role of a curve, which determines its colour and line. Measured samples are drawn as points.
enum class Ink { measured, submitted, fitted, refitted, inferred, limit };

/// Chart of curves against time. Charts of the same group zoom together.
struct Curves {
  std::string title, unit, group;  ///< title; unit of the curves; group that zooms together
  /// One curve.
  struct Series {
    std::string name;       ///< name in the legend
    Ink ink;                ///< role
    std::vector<double> y;  ///< values at `x`; NaN interrupts the curve
  };
  std::vector<double> x;                                 ///< time [s], ascending
  std::vector<Series> series = {};                       ///< curves, drawn in this order
  std::optional<std::pair<double, double>> fault = {};   ///< shaded times [s]: the fault
  std::optional<std::pair<double, double>> window = {};  ///< shaded times [s]: window furthest above noise
  std::optional<std::pair<double, double>> view = {};    ///< times that are shown first [s]; none: all
  double tolerance = 0;  ///< shaded band y = -tolerance ... tolerance; 0: none
  std::string id = {};   ///< target of links; empty: none
};

/// Horizontal bar chart with a reference line. NaN is shown as "not finite".
struct Bars {
  std::string title, unit;      ///< title; unit of the values
  double reference = 0;         ///< position of the line, 0: none
  std::string reference_label;  ///< label of the reference line
  /// One bar.
  struct Bar {
    std::string label;           ///< label to the left
    double value;                ///< length of the bar [unit]; NaN: no bar
    std::string style = "good";  ///< colour: good, poor, before or after
    std::string shown = {};      ///< text beside the bar in place of the value
  };
  std::vector<Bar> bars = {};  ///< bars from the top
};

/// Small scatter plot.
struct Scatter {
  std::string title, x_label, y_label;  ///< title; axis labels with units
  /// Points of one colour.
  struct Group {
    std::string name;                               ///< name in the legend
    Ink ink;                                        ///< role
    std::vector<std::pair<double, double>> points;  ///< x and y of each point
  };
  std::vector<Group> groups;  ///< groups of points
};

/// Heading of a section (level 2) or below it (level 3).
struct Heading {
  std::string text;  ///< title
  int level = 2;     ///< as in HTML
};
/// Paragraph. A hint is shown on the screen only; a command is meant to be copied.
struct Paragraph {
  /// Kinds of paragraphs.
  enum class Kind { plain, note, hint, command };
  std::string text;         ///< content
  Kind kind = Kind::plain;  ///< kind
  bool in_markdown = true;  ///< whether Markdown contains it
  std::string link = {};    ///< target of a link; empty: none
};
/// Verdict that opens the document: at most eight words, and the reasons.
struct Opening {
  std::string headline;              ///< verdict
  std::vector<std::string> reasons;  ///< reasons with numbers and units, one line each
  Tone tone;                         ///< colour
};
/// Verdict within the document.
struct Verdict {
  std::string sentence;  ///< sentence
  Tone tone;             ///< colour
};
/// Chips (coloured labels) with the error of each channel of each event.
struct Chips {
  /// One channel of one event.
  struct Chip {
    std::string name, value;  ///< channel; error
    Tone tone;                ///< good, warn or bad
    std::string link, hint;   ///< id of its chart; text shown while the pointer is on the chip
  };
  /// Chips of one event.
  struct Group {
    std::string name;         ///< event
    std::vector<Chip> chips;  ///< its channels
  };
  std::vector<Group> groups;  ///< events
};
/// Picture with its caption.
struct Picture {
  std::string svg, caption;  ///< picture; text below it
  std::string file = {};     ///< path in Markdown; empty: not in Markdown
};
/// Names and values without a heading.
struct Facts {
  std::vector<std::pair<std::string, std::string>> rows;  ///< name and value
};
/// Machine-readable data, not shown.
struct Data {
  std::string id, json;  ///< id of the element; content
};
/// Blank lines for name, date and signature of each role, in print only.
struct Signatures {
  std::vector<std::string> roles;  ///< "Owner", "Reviewer"
};
/// Begins a layout that ends at the matching End.
struct Begin {
  /// Large charts side by side; charts in two columns; figures in one row; a folded part with a title.
  enum class Layout { large, panels, row, fold } layout;  ///< arrangement
  std::string title = {};                                 ///< title of a folded part
};
/// Ends a layout.
struct End {};

/// Part of a document.
using Block = std::variant<Heading, Paragraph, Opening, Verdict, Chips, Table, Curves, Bars, Scatter, Picture,
                           Facts, Data, Signatures, Begin, End>;

/// Origin of a document's figures: name and value of each line.
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// Document, built from top to bottom.
struct Document {
  std::string title, subtitle;     ///< title; line below it
  std::vector<Block> blocks = {};  ///< parts in order
  /// Appends a block.
  void add(Block block) { blocks.push_back(std::move(block)); }
  /// Appends the heading of a section.
  void section(std::string text) { add(Heading{std::move(text)}); }
  /// Appends a heading below that of a section.
  void subsection(std::string text) { add(Heading{std::move(text), 3}); }
  /// Appends a paragraph; nothing if it is empty.
  void text(std::string paragraph) {
    if (!paragraph.empty()) add(Paragraph{std::move(paragraph)});
  }
  /// Appends a caution.
  void note(std::string paragraph) { add(Paragraph{std::move(paragraph), Paragraph::Kind::note}); }
  /// Appends a section "Provenance".
  void provenance(const Provenance& rows) {
    section("Provenance");
    add(Facts{rows});
  }
};

/// Returns a self-contained page: it fetches nothing, works on telephones and in print, and contains scripts
/// only if it has curves or sortable tables. All texts are escaped; SVG is not.
std::string html(const Document& document);
/// Returns the document's headings, paragraphs, tables, facts and pictures with a file as Markdown.
std::string markdown(const Document& document);

/// Returns the table as Markdown.
std::string markdown(const Table& table);
/// Returns the table as CSV (RFC 4180).
std::string csv(const Table& table);
/// Table as terminal text. Column widths count characters, not bytes; the first `left` columns are
/// left-aligned.
std::string padded(const Table& table, std::size_t left = 2);

/// Returns the text with & < > " as entities.
std::string escape(std::string_view text);

}  // namespace swingbank::validate::report
