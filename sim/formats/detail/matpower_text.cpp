#include "sim/formats/detail/matpower_text.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include "base/capitals.hpp"
#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats::matpower {
namespace {

using psse::trimmed;

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

struct Statement {
  std::string text;  ///< newlines inside brackets are kept
  int line;
};

/// Splits a file into statements, without comments, continuations and empty statements.
class Splitter {
 public:
  Splitter(const std::string& text, const std::string& file, Problems& problems)
      : text_(text), file_(file), problems_(problems) {}
  std::vector<Statement> split() {
    while (at_ < text_.size()) character();
    if (!open_.empty())
      problems_.add("a '" + std::string(1, open_.back().first) + "' is not closed",
                    where(open_.back().second), "the file may be truncated", "close it or restore the file");
    else
      end();
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string where(int line) const { return file_ + ":" + std::to_string(line); }
  void character() {
    const char c = text_[at_];
    if (c == '%' || c == '#') return comment();
    if (text_.compare(at_, 3, "...") == 0) return continuation();
    if (c == '"' || (c == '\'' && !transposes())) return quoted();
    if (c == '\n') {
      ++at_;
      if (open_.empty())
        end();
      else
        now_.text += c;
      ++line_;
      return;
    }
    if (open_.empty() && (c == ';' || c == ',')) {
      ++at_;
      return end();
    }
    bracket(c);
    put(c);
    ++at_;
  }
  void put(char c) {
    if (now_.text.empty()) now_.line = line_;
    if (!now_.text.empty() || !std::isspace(static_cast<unsigned char>(c))) now_.text += c;
  }
  void bracket(char c) {
    if (c == '[' || c == '{' || c == '(') open_.emplace_back(c, line_);
    if (c != ']' && c != '}' && c != ')') return;
    const char wanted = c == ']' ? '[' : c == '}' ? '{' : '(';
    if (open_.empty() || open_.back().first != wanted)
      problems_.add("'" + std::string(1, c) + "' without a matching '" + std::string(1, wanted) + "'",
                    where(line_), "every bracket needs its counterpart", "correct the brackets");
    if (!open_.empty()) open_.pop_back();
  }
  void end() {
    now_.text = trimmed(now_.text);
    if (!now_.text.empty()) out_.push_back(std::move(now_));
    now_ = {};
  }
  [[nodiscard]] std::size_t line_end() const { return std::min(text_.find('\n', at_), text_.size()); }
  void comment() {
    const auto begin = text_.rfind('\n', at_) == std::string::npos ? 0 : text_.rfind('\n', at_) + 1;
    const std::string line = trimmed(text_.substr(begin, line_end() - begin));
    at_ = line_end();
    if (line != "%{" && line != "#{") return;
    const int first = line_;
    for (int depth = 1; depth > 0;) {  // nested block comments
      if (at_ >= text_.size()) {
        problems_.add("a block comment is not closed", where(first),
                      "the comment extends to the end of the file", "close it with %}");
        return;
      }
      ++at_;
      ++line_;
      const std::string inner = trimmed(text_.substr(at_, line_end() - at_));
      depth += inner == "%{" || inner == "#{" ? 1 : inner == "%}" || inner == "#}" ? -1 : 0;
      at_ = line_end();
    }
  }
  void continuation() {
    at_ = std::min(line_end() + 1, text_.size());
    ++line_;
    put(' ');
  }
  /// Returns true if a quote transposes the preceding value; elsewhere it begins a string.
  [[nodiscard]] bool transposes() const {
    if (at_ == 0) return false;
    const char before = text_[at_ - 1];
    return is_word(before) || before == ')' || before == ']' || before == '}' || before == '.' ||
           before == '\'';
  }
  void quoted() {
    const char mark = text_[at_];
    std::size_t i = at_ + 1;
    for (const std::size_t stop = line_end(); i < stop; ++i) {
      if (text_[i] != mark) continue;
      if (i + 1 >= text_.size() || text_[i + 1] != mark) break;
      ++i;  // a doubled quote represents one quote
    }
    if (i >= line_end()) {
      problems_.add("a quote is not closed", where(line_), "the text runs to the end of the line",
                    "close it with " + std::string(1, mark));
      i = line_end() - 1;
    }
    for (; at_ <= i; ++at_) put(text_[at_]);
  }

  const std::string& text_;
  const std::string& file_;
  Problems& problems_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::vector<std::pair<char, int>> open_;
  Statement now_{};
  std::vector<Statement> out_;
};

std::optional<long double> number(const std::string& word) {
  const std::string upper = capitals(word);
  if (upper == "INF" || upper == "+INF") return std::numeric_limits<long double>::infinity();
  if (upper == "-INF") return -std::numeric_limits<long double>::infinity();
  return psse::parse_number(word);
}

/// Returns the rows between the brackets of a matrix.
std::vector<Row> read_rows(const std::string& text, int line, const std::string& file, Problems& problems) {
  std::vector<Row> rows;
  Row row{line, {}};
  const auto end_row = [&] {
    if (!row.values.empty()) rows.push_back(row);
    row.values.clear();
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (c == '\n' || c == ';') end_row();
    if (c == '\n' || c == ';' || c == ',' || std::isspace(static_cast<unsigned char>(c))) {
      ++i;
      continue;
    }
    std::string word;
    while (i < text.size() && !std::isspace(static_cast<unsigned char>(text[i])) && text[i] != ',' &&
           text[i] != ';')
      word += text[i++];
    const auto value = number(word);
    if (!value)
      problems.add("'" + word + "' is not a number", file + ":" + std::to_string(line),
                   "a matrix of a case contains only numbers", "write the value as a number");
    if (row.values.empty()) row.line = line;
    row.values.push_back(value.value_or(0.0L));
  }
  end_row();
  return rows;
}

/// Returns true for statements without a value: function, end, endfunction, return.
bool passed_over(const std::string& text) {
  for (const char* word : {"function", "end", "endfunction", "return"}) {
    const std::string w = word;
    if (text.compare(0, w.size(), w) == 0 && (text.size() == w.size() || !is_word(text[w.size()])))
      return w == "function" || text == w;
  }
  return false;
}

void not_understood(const Statement& s, const std::string& file, Problems& problems) {
  std::string shown = s.text.substr(0, s.text.find('\n'));
  if (shown.size() > 40) shown = shown.substr(0, 40) + "...";
  problems.add("unsupported statement '" + shown + "'", file + ":" + std::to_string(s.line),
               "only assignments of numbers, strings, matrices and cell arrays are read; expressions are not "
               "evaluated",
               "save the case with savecase, which writes plain numbers");
}

std::optional<Assignment> read_assignment(const Statement& s, const std::string& file, Problems& problems) {
  const auto equals = s.text.find('=');
  const std::string left = trimmed(s.text.substr(0, equals));
  const auto dot = left.find('.');
  const bool named = equals != std::string::npos && dot != std::string::npos && dot > 0 &&
                     dot + 1 < left.size() &&
                     std::ranges::all_of(left, [](char c) { return is_word(c) || c == '.'; });
  if (!named) {
    not_understood(s, file, problems);
    return {};
  }
  Assignment a{left.substr(dot + 1), s.line, Assignment::matrix, {}, {}};
  const std::string all = s.text.substr(equals + 1), right = trimmed(all);
  const int line =
      s.line + static_cast<int>(std::count(
                   s.text.begin(), s.text.begin() + static_cast<std::ptrdiff_t>(s.text.find(right)), '\n'));
  const char first = right.empty() ? ' ' : right.front(), last = right.empty() ? ' ' : right.back();
  if (first == '[' && last == ']' && right.find('[', 1) == std::string::npos) {
    a.rows = read_rows(right.substr(1, right.size() - 2), line, file, problems);
  } else if (first == '{' && last == '}') {
    a.kind = Assignment::cell;
  } else if ((first == '\'' || first == '"') && right.size() > 1 && last == first) {
    a.kind = Assignment::text;
    a.words = right.substr(1, right.size() - 2);
  } else if (const auto value = number(right)) {
    a.rows = {{line, {*value}}};
  } else {
    not_understood(s, file, problems);
    return {};
  }
  return a;
}

}  // namespace

std::vector<Assignment> read_assignments(const std::string& text, const std::string& file,
                                         Problems& problems) {
  std::vector<Assignment> out;
  for (const Statement& s : Splitter(text, file, problems).split())
    if (!passed_over(s.text))
      if (auto a = read_assignment(s, file, problems)) out.push_back(std::move(*a));
  return out;
}

}  // namespace swingbank::sim::formats::matpower
