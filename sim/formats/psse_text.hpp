#pragma once
// PSS/E free format: fields separated by commas or blanks, names in quotes, '/' at the end of a record. The
// readers of the other formats use its lines, fields and numbers.
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::psse {

/// One field of a record.
struct Field {
  std::string text;     ///< without quotes, and without blanks at both ends
  bool quoted = false;  ///< whether it was written in quotes
};
/// One record, or one line of a record. An empty unquoted field means the default.
struct Record {
  int line = 0;               ///< line in the file, from 1
  bool ended = false;         ///< true if it ends with '/'
  std::vector<Field> fields;  ///< fields in order
  std::string place = {};     ///< place in messages, if it is not a line of the file
};

/// Returns the lines of a text file without '\n'; a '\r' before it remains. Throws InputError if it cannot be
/// read.
std::vector<std::string> read_lines(const std::filesystem::path& file);
/// The same for a string.
std::vector<std::string> lines_of(const std::string& text);
/// Removes the byte-order mark that some editors write before the first line. Returns true if there was one.
bool erase_byte_order_mark(std::vector<std::string>& lines);
/// Returns the text without leading and trailing blanks and line ends.
std::string trimmed(std::string_view text);
/// Characters that begin a comment at the end of a line of a .raw or .dyr, where a field would begin.
constexpr std::string_view kCommentMarks = "#!";
/// Splits one line. An open quote becomes a problem. One of `comment_marks` where a field would begin ends
/// the line. After a comma, a name or id among the first four fields may begin with such a character.
Record split(const std::string& line, int number, const std::string& file, Problems& problems,
             std::string_view comment_marks = {});

/// Returns true for a record that begins with 0.
bool ends_section(const Record& record);
/// Returns true for a record that begins with Q.
bool ends_file(const Record& record);

/// Typed access to the fields of a record. Missing and non-numeric fields become problems, with file and
/// line.
class Fields {
 public:
  /// `record` and `problems` must outlive the object. `file`: name in messages.
  Fields(const Record& record, std::string file, Problems& problems)
      : record_(record), file_(std::move(file)), problems_(problems) {}
  /// Returns the value of field `i`. An invalid value is a problem; so is a missing field without `fallback`.
  /// An invalid or missing field gives the fallback, or zero without one.
  int integer(std::size_t i, const char* name, std::optional<int> fallback = {});
  /// Returns the value of field `i`, as integer() does.
  long double number(std::size_t i, const char* name, std::optional<long double> fallback = {});
  /// Returns the text of field `i`, or the fallback if the field is missing or empty.
  std::string text(std::size_t i, const std::string& fallback) const;
  /// Returns the line of the record in the file, from 1.
  [[nodiscard]] int line() const { return record_.line; }
  /// Returns the place of the record for messages, "FILE:LINE".
  [[nodiscard]] std::string where() const {
    return record_.place.empty() ? file_ + ":" + std::to_string(record_.line) : record_.place;
  }
  /// Returns the number of fields.
  [[nodiscard]] std::size_t size() const { return record_.fields.size(); }

 private:
  [[nodiscard]] const Field* given(std::size_t i) const;
  void missing(const char* name);
  const Record& record_;
  std::string file_;
  Problems& problems_;
};

/// Parses a finite decimal number, including 'D' exponents. Returns none for any other string.
std::optional<long double> parse_number(std::string text);

/// Returns the shortest decimal of `scale * value` that restores `value` when a reader divides it by `scale`
/// in extended precision. Double precision is insufficient: not every double x has a double y with y/scale ==
/// x.
std::string shortest(double value, long double scale = 1.0L);
/// Degrees per radian: files contain degrees, the network radians.
constexpr long double kDegrees = 180.0L / std::numbers::pi_v<long double>;
/// Returns the text in single quotes, with inner quotes doubled.
std::string quote(const std::string& text);

}  // namespace swingbank::sim::formats::psse
