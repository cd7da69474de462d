// Reader of .dyr files; models can be ignored or read as other models.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "base/capitals.hpp"
#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats {
namespace {

/// Returns true if the whole line is a comment ('//' or '@!'). Such lines may occur inside a record.
bool is_comment(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  return first != std::string::npos &&
         (line.compare(first, 2, "//") == 0 || line.compare(first, 2, "@!") == 0);
}

/// Expands repeated values of Fortran's free format: 3*0.5 is 0.5 0.5 0.5.
void write_out_repeats(std::vector<psse::Field>& fields) {
  constexpr std::size_t most = 1000;  // more than any model has parameters
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string& text = fields[i].text;
    const auto star = text.find('*');
    std::size_t count = 0;
    if (fields[i].quoted || star == std::string::npos ||
        std::from_chars(text.data(), text.data() + star, count).ptr != text.data() + star || count == 0 ||
        count > most || (star + 1 < text.size() && !psse::parse_number(text.substr(star + 1))))
      continue;
    const psse::Field value{text.substr(star + 1), false};
    fields[i] = value;
    fields.insert(fields.begin() + static_cast<std::ptrdiff_t>(i), count - 1, value);
    i += count - 1;
  }
}

/// Returns the number of codes before the parameters of a user-written model: IC, IT, NI, NC, NS, NV, and one
/// more in a load's record.
std::size_t codes_of(const std::string& wrapper) {
  constexpr std::size_t of_all = 6;
  return wrapper == "USRLOD" ? of_all + 1 : of_all;
}

class DyrReader {
 public:
  DyrReader(std::vector<std::string> lines, std::string name, const DyrOptions& options)
      : lines_(std::move(lines)), name_(std::move(name)) {
    psse::erase_byte_order_mark(lines_);
    constexpr char end_of_file = 0x1A;  // Ctrl-Z, the end of a text file in DOS
    for (std::size_t i = 0; i < lines_.size(); ++i)
      if (const auto at = lines_[i].find(end_of_file); at != std::string::npos) {
        lines_[i].erase(at);
        lines_.resize(i + 1);
      }
    for (const auto& model : options.ignore) ignore_.insert(capitals(model));
    for (const auto& [from, to] : options.map) map_.emplace(capitals(from), capitals(to));
  }

  std::vector<DyrRecord> read() {
    split_records();
    check_names();
    if (!problems_.empty())
      for (const DyrRecord& record : out_) problems_.add(record.faults);
    problems_.raise();
    if (!ignored_.empty()) spdlog::warn("{}: ignored (--ignore-model): {}", name_, ignored_);
    return std::move(out_);
  }
  DyrSurvey survey() {
    split_records();
    return {std::move(out_), problems_.list()};
  }

 private:
  void split_records() {
    psse::Record open;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (is_comment(lines_[i])) continue;
      auto piece = psse::split(lines_[i], static_cast<int>(i) + 1, name_, problems_, psse::kCommentMarks);
      write_out_repeats(piece.fields);
      if (is_end(piece, open.fields.empty())) {
        if (const int line = next_content(i + 1); line > 0)
          problems_.add("records after the end mark", name_ + ":" + std::to_string(line),
                        "line " + std::to_string(i + 1) + " (Q or 0) ends the file",
                        "remove that line, or the records after it");
        break;
      }
      if (!open.fields.empty() && begins_record(piece)) {
        finish(open, true);
        open.fields.clear();
      }
      if (open.fields.empty()) open.line = piece.line;
      open.fields.insert(open.fields.end(), piece.fields.begin(), piece.fields.end());
      if (!piece.ended || open.fields.empty()) continue;
      finish(open, false);
      open.fields.clear();
    }
    if (!open.fields.empty()) finish(open, true);
  }
  /// Returns true for the end of the file: a line with Q alone or a record with 0 alone.
  static bool is_end(const psse::Record& line, bool between_records) {
    if (line.fields.size() != 1) return false;
    return psse::ends_file(line) || (between_records && line.ended && psse::ends_section(line));
  }
  /// Returns the number of the first line from `i` on with a field, or 0.
  [[nodiscard]] int next_content(std::size_t i) const {
    Problems of_the_rest;
    for (; i < lines_.size(); ++i) {
      const int number = static_cast<int>(i) + 1;
      if (is_comment(lines_[i])) continue;
      const psse::Record line = psse::split(lines_[i], number, name_, of_the_rest, psse::kCommentMarks);
      if (!line.fields.empty() && !is_end(line, true)) return number;
    }
    return 0;
  }
  /// Returns true if a line begins with an integer and a model's name. No model has parameters that could be
  /// mistaken for these.
  static bool begins_record(const psse::Record& line) {
    constexpr std::size_t shortest_name = 4;
    if (line.fields.size() < 3 || line.fields[0].quoted || !line.fields[1].quoted) return false;
    const std::string &bus = line.fields[0].text, &model = line.fields[1].text;
    const auto is = [](int (*kind)(int)) { return [kind](unsigned char c) { return kind(c) != 0; }; };
    return !bus.empty() && std::ranges::all_of(bus, is(std::isdigit)) && model.size() >= shortest_name &&
           std::isalpha(static_cast<unsigned char>(model[0])) && std::ranges::all_of(model, is(std::isalnum));
  }
  [[nodiscard]] std::string where(int line) const { return name_ + ":" + std::to_string(line); }

  void finish(const psse::Record& record, bool unended) {
    psse::Fields fields(record, name_, problems_);
    const std::string model = capitals(fields.text(1, ""));
    const bool user = model.starts_with("USR");
    // The name of a user-written model is the last string before the numbers: after the id, or in its place.
    const bool named_fourth = user && fields.size() > 3 && record.fields[3].quoted;
    const std::string user_name = user ? capitals(fields.text(named_fourth ? 3 : 2, "")) : "";
    if (leave_out(model, user_name, record.line)) return;
    const bool by_name = record.fields[0].quoted && !psse::parse_number(record.fields[0].text);
    if (fields.size() < (by_name ? 2 : 3)) {
      problems_.add("incomplete record", fields.where(),
                    std::string("a record is: bus number, 'MODEL', id, parameters, /") +
                        (unended ? "; this record has no '/': the file may be truncated there" : ""),
                    "complete the record or remove it");
      return;
    }
    DyrRecord dyr{by_name ? 0 : fields.integer(0, "bus number"),
                  mapped(model, user_name),
                  fields.text(2, ""),
                  {},
                  record.line};
    if (by_name) dyr.equipment = record.fields[0].text;
    dyr.user = dyr.model == model ? user_name : "";
    if (user) dyr.codes = codes_of(model);
    dyr.unended = unended;
    Problems no_number;
    psse::Fields numbers(record, name_, dyr.faults), texts(record, name_, no_number);
    for (std::size_t i = named_fourth ? 4 : 3; i < fields.size(); ++i) {
      const bool quoted = record.fields[i].quoted;
      const int number = static_cast<int>(dyr.values.size()) + 1;
      const std::string what = fmt::format("{} parameter {}", dyr.model, number);
      if (record.fields[i].text.empty() && !quoted) dyr.empty.push_back(number);
      dyr.values.push_back(static_cast<double>((quoted ? texts : numbers).number(i, what.c_str(), 0.0L)));
      if (no_number.empty()) continue;
      dyr.texts.push_back({dyr.values.size() - 1, no_number});
      no_number = {};
    }
    out_.push_back(std::move(dyr));
  }

  bool leave_out(const std::string& model, const std::string& user, int line) {
    for (const std::string& name : {user, model}) {
      if (name.empty() || !ignore_.contains(name)) continue;
      used_.insert(name);
      ignored_ += (ignored_.empty() ? "" : ", ") + name + " on line " + std::to_string(line);
      return true;
    }
    return false;
  }

  std::string mapped(const std::string& model, const std::string& user) {
    for (const std::string& name : {user, model}) {
      const auto found = map_.find(name);
      if (name.empty() || found == map_.end()) continue;
      used_.insert(name);
      return found->second;
    }
    return model;
  }

  void check_names() {
    std::set<std::string> asked = ignore_;
    for (const auto& [from, to] : map_) {
      if (asked.contains(from))
        problems_.add("model " + from + " is both ignored and mapped", name_,
                      "a model can be ignored or mapped, not both", "drop one of the two options");
      asked.insert(from);
    }
    for (const std::string& name : asked)
      if (!used_.contains(name) && !(ignore_.contains(name) && map_.contains(name)))
        problems_.add("no model " + name + " to ignore or map", name_, "the file has no record of that name",
                      "correct the name, or remove it from --ignore-model or --map-model (in a config: "
                      "ignore_models, map_models)");
  }

  std::vector<std::string> lines_;
  std::string name_;
  std::set<std::string> ignore_, used_;
  std::map<std::string, std::string> map_;
  std::string ignored_;
  Problems problems_;
  std::vector<DyrRecord> out_;
};

}  // namespace

void add_model_map(DyrOptions& options, const std::string& text, const std::string& where,
                   Problems& problems) {
  const auto cut = text.find('=');
  if (cut == 0 || cut == std::string::npos || cut + 1 == text.size()) {
    problems.add("'" + text + "'", where, "a mapping is FROM=TO", "write it like GENROA=GENROU");
    return;
  }
  const std::string from = capitals(text.substr(0, cut));
  if (!options.map.emplace(from, text.substr(cut + 1)).second)
    problems.add("model " + from + " is mapped twice", where, "a model can be mapped to one other model only",
                 "keep one of the mappings");
}

DyrOptions read_dyr_options(Config& config, const std::string& prefix) {
  DyrOptions options;
  options.ignore = config.optional<std::vector<std::string>>(prefix + "ignore_models", {},
                                                             {.meaning = "models of the .dyr to ignore"});
  const std::string key = prefix + "map_models";
  Problems problems;
  for (const auto& text : config.optional<std::vector<std::string>>(
           key, {}, {.meaning = "FROM=TO: read model FROM of the .dyr as model TO"}))
    add_model_map(options, text, config.where(key), problems);
  for (const Problem& p : problems.list()) config.problem(key, p.what, p.why, p.remedy);
  return options;
}

std::vector<DyrRecord> read_dyr(const std::filesystem::path& file, const DyrOptions& options) {
  return DyrReader(psse::read_lines(file), file.string(), options).read();
}
std::vector<DyrRecord> parse_dyr(const std::string& text, const std::string& name,
                                 const DyrOptions& options) {
  return DyrReader(psse::lines_of(text), name, options).read();
}
DyrSurvey survey_dyr(const std::filesystem::path& file) {
  return DyrReader(psse::read_lines(file), file.string(), {}).survey();
}

}  // namespace swingbank::sim::formats
