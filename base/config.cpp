#include "base/config.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

#include "base/capitals.hpp"
#include "base/detail/key_trace.hpp"
#include "base/input_file.hpp"
#include "base/nearest_word.hpp"

namespace swingbank {

namespace fs = std::filesystem;

struct Config::Tree {
  toml::table root;
  std::set<std::string> asked;  ///< keys that were read

  [[nodiscard]] const toml::node* at(const std::string& key) const { return root.at_path(key).node(); }
};

namespace {

std::string place(const fs::path& name, const toml::source_position& p) {
  return fmt::format("{}:{}:{}", name.string(), p.line, p.column);
}

std::string list(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, ", ")); }
/// Returns `remedy`, the list `words`, and the entry of `free` that is nearest to `word`: "use one of:
/// GENCLS, GENROU; did you mean GENROU?".
std::string choose_from(std::string_view word, const std::vector<std::string>& words,
                        const std::vector<std::string>& free, const std::string& remedy) {
  const std::string nearest = nearest_word(word, free);
  return remedy + list(words) + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

// Conversion of a TOML node to T, and the name of T in messages.
bool convert(const toml::node& n, bool& v) { return n.is_boolean() && (v = n.as_boolean()->get(), true); }
bool convert(const toml::node& n, std::int64_t& v) {
  return n.is_integer() && (v = n.as_integer()->get(), true);
}
bool convert(const toml::node& n, std::string& v) {
  return n.is_string() && (v = n.as_string()->get(), true);
}
bool convert(const toml::node& n, double& v) {
  if (n.is_integer()) return v = static_cast<double>(n.as_integer()->get()), true;
  return n.is_floating_point() && (v = n.as_floating_point()->get(), true);
}
template <class T>
bool convert(const toml::node& n, std::vector<T>& v) {
  if (!n.is_array()) return false;
  for (const auto& element : *n.as_array()) {
    T one{};
    if (!convert(element, one)) return false;
    v.push_back(one);
  }
  return true;
}

std::string kind(const bool*) { return "true or false"; }
std::string kind(const std::int64_t*) { return "an integer"; }
std::string kind(const double*) { return "a number"; }
std::string kind(const std::string*) { return "a text in quotes"; }
template <class T>
std::string kind(const std::vector<T>*) {
  return "a list, each element " + kind(static_cast<const T*>(nullptr));
}

bool inside(double v, const Range& r) { return std::isfinite(v) && v >= r.low && v <= r.high; }
bool inside(std::int64_t v, const Range& r) { return inside(static_cast<double>(v), r); }
bool inside(bool, const Range&) { return true; }
bool inside(const std::string&, const Range&) { return true; }
template <class T>
bool inside(const std::vector<T>& v, const Range& r) {
  for (const auto& one : v)
    if (!inside(one, r)) return false;
  return true;
}

std::string describe(const Range& r) {
  const std::string unit = r.unit.empty() || r.unit == "-" ? "" : " " + r.unit;
  if (std::isinf(r.low) && std::isinf(r.high)) return "a finite number" + unit;
  if (std::isinf(r.high)) return fmt::format("at least {}{}", r.low, unit);
  if (std::isinf(r.low)) return fmt::format("at most {}{}", r.high, unit);
  return fmt::format("{} to {}{}", r.low, r.high, unit);
}

std::string written(const toml::node& n) {
  if (const auto* number = n.as_floating_point()) return fmt::format("{:#}", number->get());  // 0.006, 2.0
  std::ostringstream text;
  n.visit([&](const auto& value) { text << value; });
  return text.str();
}

/// Adds a problem for every key that was never read.
void unknown(const toml::table& table, const std::string& prefix, const std::set<std::string>& asked,
             const fs::path& name, Problems& problems) {
  std::vector<std::string> known, missing;  // missing: keys that the table lacks, for "did you mean"
  for (const auto& key : asked)
    if (key.starts_with(prefix) && key.find('.', prefix.size()) == std::string::npos) {
      known.push_back(key.substr(prefix.size()));
      if (!table.contains(known.back())) missing.push_back(known.back());
    }
  for (const auto& [key, node] : table) {
    const std::string full = prefix + std::string(key.str());
    if (asked.contains(full)) continue;
    const bool inner = node.is_table() && asked.lower_bound(full + ".") != asked.end() &&
                       asked.lower_bound(full + ".")->starts_with(full + ".");
    if (inner)
      unknown(*node.as_table(), full + ".", asked, name, problems);
    else
      problems.add(
          "unknown key " + full, place(name, key.source().begin),
          prefix.empty() ? "Swingbank has no such key"
                         : "Swingbank has no such key in [" + prefix.substr(0, prefix.size() - 1) + "]",
          known.empty() ? "remove it" : choose_from(key.str(), known, missing, "remove it or use one of: "));
  }
}

/// Largest number of parts of a dotted key. toml++ limits the nesting of values to 256. Dotted keys can
/// exceed that limit; the recursive destructor of the tables would then overflow the stack.
constexpr int kMostKeyParts = 32;

/// Scanner of a TOML text that counts the dots of each key outside strings and comments.
class KeyLengths {
 public:
  KeyLengths(std::string_view text, const fs::path& name) : text_(text), name_(name) {}

  /// Throws InputError for the first key of more than kMostKeyParts parts.
  void check() {
    int dots = 0;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size());
      if (at_ == text_.size()) return;
      if (text_[at_] == '.' && ++dots >= kMostKeyParts) refuse();
      if (std::string_view("\n=,[]{}").find(text_[at_]) != std::string_view::npos) dots = 0;
      step();
    }
  }

 private:
  void step() {
    if (text_[at_++] == '\n') ++line_, begin_ = at_;
  }
  /// Moves past the closing quotes, or to the end of the line if a one-line string lacks them.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool lines = text_.substr(at_, 3) == three;
    at_ += lines ? 3 : 1;
    while (at_ < text_.size()) {
      if (!lines && text_[at_] == '\n') return;
      if (lines ? text_.substr(at_, 3) == three : text_[at_] == quote) break;
      if (quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size()) step();
      step();
    }
    at_ = std::min(at_ + (lines ? 3 : 1), text_.size());
    for (int more = 0; lines && more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) ++at_;
  }
  [[noreturn]] void refuse() const {
    throw InputError({fmt::format("a key nested deeper than {} levels", kMostKeyParts),
                      fmt::format("{}:{}:{}", name_.string(), line_, at_ - begin_ + 1),
                      "such deep nesting is not supported", "write a key with fewer levels"});
  }

  std::string_view text_;
  const fs::path& name_;
  std::size_t at_ = 0, begin_ = 0, line_ = 1;
};

/// Parses the text; after an error, parses it once more. toml++ reads numbers through a stream, which reports
/// a failed allocation as a malformed number. Only an error that recurs is an error of the text.
toml::table parse(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error&) {
    return toml::parse(text, name);
  }
}

}  // namespace

Config::Config(const fs::path& file)
    : Config(read_input(file, "cannot read the config", "check the path"), file) {}

Config::Config(const std::string& text, const fs::path& name) : name_(name), tree_(std::make_shared<Tree>()) {
  KeyLengths(text, name).check();
  try {
    tree_->root = parse(text, name.string());
  } catch (const toml::parse_error& e) {
    throw InputError(
        {"not TOML", place(name, e.source().begin), std::string(e.description()), "correct the line"});
  }
}

Config::Config(std::shared_ptr<KeyTrace> trace) : tree_(std::make_shared<Tree>()), trace_(std::move(trace)) {}

bool Config::has(const std::string& key) const {
  return trace_ ? trace_->present(key) : tree_->at(key) != nullptr;
}
bool Config::is_array(const std::string& key) const {
  return trace_ ? trace_->arrays() : has(key) && tree_->at(key)->is_array();
}
bool Config::is_table(const std::string& key) const {
  return trace_ ? !trace_->arrays() : has(key) && tree_->at(key)->is_table();
}
bool Config::is_text(const std::string& key) const {
  return trace_ ? trace_->arrays() : has(key) && tree_->at(key)->is_string();
}

std::vector<std::string> Config::keys(const std::string& table) const { return keys(table, {}); }

std::vector<std::string> Config::keys(const std::string& table, const std::vector<std::string>& known,
                                      const std::string& opened_by) const {
  if (trace_) return trace_->names(table, known, opened_by);
  std::vector<std::string> names;
  const toml::node* n = tree_->at(table);
  if (n != nullptr && n->is_table())
    for (const auto& [key, node] : *n->as_table()) names.emplace_back(key.str());
  return names;
}

std::string Config::where(const std::string& key) const {
  for (std::string at = key;; at.resize(at.rfind('.'))) {
    if (const toml::node* n = tree_->at(at); n && n->source().begin.line > 0)
      return place(name_, n->source().begin);
    if (at.find('.') == std::string::npos) return name_.string();
  }
}

std::pair<unsigned, unsigned> Config::position(const std::string& key) const {
  if (tree_->at(key) == nullptr) return {0, 0};
  const auto begin = tree_->at(key)->source().begin;
  return {begin.line, begin.column};
}

void Config::ignore(const std::string& key) { tree_->asked.insert(key); }

void Config::problem(const std::string& key, const std::string& what, const std::string& why,
                     const std::string& remedy) {
  problems_.add(what, where(key), why, remedy);
}

void Config::exclude(const std::string& key, const std::string& what, const std::string& why,
                     const std::string& remedy) {
  if (trace_ || !has(key)) return;
  ignore(key);
  problem(key, what, why, remedy);
}

template <class T>
bool Config::take(const std::string& key, T& value, const Range& range) {
  tree_->asked.insert(key);
  const toml::node* n = tree_->at(key);
  if (n == nullptr) return false;
  T found{};
  if (!convert(*n, found)) {
    problem(key, key + " = " + written(*n), "it must be " + kind(static_cast<const T*>(nullptr)),
            "correct the value");
  } else if (!inside(found, range)) {
    problem(key, key + " = " + written(*n), "it must be " + describe(range), "correct the value");
  } else {
    value = std::move(found);
  }
  return true;
}

template <class T>
T Config::require(const std::string& key, const Range& range) {
  if (trace_) return trace_->leaf<T>(key, true, range);
  T value{};
  if (!take(key, value, range))
    problem(key, "missing key " + key, "it has no default",
            "add it: " + kind(static_cast<const T*>(nullptr)) +
                (std::isinf(range.low) && std::isinf(range.high) ? "" : ", " + describe(range)));
  return value;
}

template <class T>
T Config::optional(const std::string& key, T otherwise, const Range& range) {
  if (trace_) return trace_->leaf<T>(key, false, range, &otherwise);
  take(key, otherwise, range);
  return otherwise;
}

std::string Config::choice(const std::string& key, const std::vector<std::string>& words,
                           const Range& about) {
  if (trace_) return trace_->word(key, words, about, nullptr);
  if (!has(key)) {
    tree_->asked.insert(key);
    problem(key, "missing key " + key, "it has no default", "add it: one of " + list(words));
    return {};
  }
  return choice(key, words, std::string());
}

std::string Config::choice(const std::string& key, const std::vector<std::string>& words,
                           const std::string& otherwise, const Range& about) {
  if (trace_) return trace_->word(key, words, about, &otherwise);
  std::string word = otherwise;
  if (!take(key, word, {}) || !is_text(key)) return word;
  if (std::find(words.begin(), words.end(), word) == words.end())
    problem(key, key + " = '" + word + "'", "this value is not allowed",
            choose_from(word, words, words, "use one of: "));
  return word;
}

std::string Config::branch(const std::string& key, const Branch& branch, const Range& about) {
  if (trace_) return trace_->branch(key, branch, about);
  std::vector<std::string> words = branch.words;
  if (branch.any_case && is_text(key)) {
    const std::string written = tree_->at(key)->value_or(std::string());
    if (std::ranges::any_of(words, [&](const auto& w) { return capitals(w) == capitals(written); }))
      words.push_back(written);
  }
  return choice(key, words);
}

std::vector<std::string> Config::table_names(const std::string& key, const Range& about) {
  auto names = require<std::vector<std::string>>(key, about);
  return trace_ ? std::vector<std::string>{kAnyName} : names;
}

fs::path Config::file(const std::string& key, const Range& about) {
  const auto text = require<std::string>(key, about);
  if (text.empty()) {
    if (!trace_ && is_text(key))
      problem(key, key + " = ''", "it must name a file",
              "give a path; it is relative to the config's folder");
    return {};
  }
  const fs::path path = fs::path(text).is_absolute() ? fs::path(text) : name_.parent_path() / text;
  if (!fs::is_regular_file(path))
    problem(key, key + " = '" + text + "'", "there is no file " + path.lexically_normal().string(),
            "correct the path; it is relative to the config's folder");
  return path.lexically_normal();
}

std::pair<double, double> Config::interval(const std::string& key, const Range& range) {
  if (trace_) return trace_->interval(key, range);
  const auto v = require<std::vector<double>>(key, range);
  if (v.size() == 2 && v[0] <= v[1]) return {v[0], v[1]};
  const bool empty = is_array(key) && tree_->at(key)->as_array()->empty();
  if (is_array(key) && v.size() != 2 && (empty || !v.empty()))  // require() reports elements of other types
    problem(key, key + " has " + std::to_string(v.size()) + " numbers", "an interval has two",
            "write [low, high]");
  if (v.size() == 2)
    problem(key, fmt::format("{} = [{}, {}]", key, v[0], v[1]), "the low end lies above the high end",
            "write [low, high]");
  return {0.0, 0.0};
}

void Config::raise() {
  if (trace_) return;
  unknown(tree_->root, "", tree_->asked, name_, problems_);
  problems_.raise();
}

#define SWINGBANK_CONFIG_TYPE(T)                                   \
  template T Config::require<T>(const std::string&, const Range&); \
  template T Config::optional<T>(const std::string&, T, const Range&);
SWINGBANK_CONFIG_TYPE(bool)
SWINGBANK_CONFIG_TYPE(std::int64_t)
SWINGBANK_CONFIG_TYPE(double)
SWINGBANK_CONFIG_TYPE(std::string)
SWINGBANK_CONFIG_TYPE(std::vector<std::int64_t>)
SWINGBANK_CONFIG_TYPE(std::vector<double>)
SWINGBANK_CONFIG_TYPE(std::vector<std::string>)
#undef SWINGBANK_CONFIG_TYPE

}  // namespace swingbank
