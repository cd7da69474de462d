#pragma once
// PSS/E free format: fields separated by commas or blanks, names in quotes, a record ends at '/'. Used by the
// readers and writers of .raw and .dyr only.
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::psse {

struct Field {
  std::string text;  ///< without quotes, blanks at both ends removed
  bool quoted = false;
};
/// One record, or one line of a record. An empty unquoted field stands for "left at its default".
struct Record {
  int line = 0;        ///< in the file, from 1
  bool ended = false;  ///< a '/' closed it
  std::vector<Field> fields;
  std::string place = {};  ///< where it stands, if not on a line of its own
};

/// Lines of a text file without their line ends. Throws InputError if it cannot be read.
std::vector<std::string> read_lines(const std::filesystem::path& file);
/// The same of a text.
std::vector<std::string> lines_of(const std::string& text);
/// What begins a comment at the end of a line of a .raw or .dyr, in a field's place.
constexpr std::string_view kCommentMarks = "#!";
/// Splits one line. An open quote is reported in `problems`. A field cannot begin with one of
/// `comment_marks`: the line ends there. Of the first fields, which hold names and ids, one may do so behind
/// a comma.
Record split(const std::string& line, int number, const std::string& file, Problems& problems,
             std::string_view comment_marks = {});

/// A record that begins with 0 ends a section, one that begins with Q the file.
bool ends_section(const Record& record);
bool ends_file(const Record& record);

/// Typed access to the fields of a record: what is missing or no number goes to `problems`, with file and
/// line.
class Fields {
 public:
  Fields(const Record& record, std::string file, Problems& problems)
      : record_(record), file_(std::move(file)), problems_(problems) {}
  /// Without a fallback the field is required. Returns the fallback (or zero) where there is no valid value.
  int integer(std::size_t i, const char* name, std::optional<int> fallback = {});
  long double number(std::size_t i, const char* name, std::optional<long double> fallback = {});
  std::string text(std::size_t i, const std::string& fallback) const;
  [[nodiscard]] int line() const { return record_.line; }
  [[nodiscard]] std::string where() const {
    return record_.place.empty() ? file_ + ":" + std::to_string(record_.line) : record_.place;
  }
  [[nodiscard]] std::size_t size() const { return record_.fields.size(); }

 private:
  [[nodiscard]] const Field* given(std::size_t i) const;
  void missing(const char* name);
  const Record& record_;
  std::string file_;
  Problems& problems_;
};

/// A finite decimal number, 'D' exponents included; nothing if the text is anything else.
std::optional<long double> parse_number(std::string text);

/// The shortest decimal of `scale * value` that reads back as `value`, when the reader divides by `scale` in
/// extended precision. Extended, because not every double x has a double y with y/scale == x.
std::string shortest(double value, long double scale = 1.0L);
/// Degrees in a radian: files hold degrees, the network radians.
constexpr long double kDegrees = 180.0L / std::numbers::pi_v<long double>;
/// 'name', with quotes inside doubled.
std::string quote(const std::string& text);

}  // namespace swingbank::sim::formats::psse
