#pragma once
// Strict TOML reader. Keys are dotted paths ("fault.start"). Every problem is recorded with file:line:column:
// a missing or unknown key, a wrong type, a value outside its range. raise() throws all of them together.
//   Config c(file);
//   const double start = c.require<double>("fault.start", {0.0, 100.0, "s"});
//   const auto seed = c.optional<std::int64_t>("seed", 1);
//   c.raise();
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/problem.hpp"

namespace swingbank {

class KeyTrace;

/// Allowed values of a key: closed interval of a number, or pattern of a text; with unit and description.
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  ///< ends of the interval [unit]
  std::string unit = "";     ///< unit in messages; empty: none
  std::string meaning = "";  ///< description of the key in the schema (base/describe.hpp)
  std::string pattern =
      "";  ///< regular expression of a text, in the schema; the reader checks the text itself
};

/// Placeholder for an arbitrary key name while a schema is derived (base/describe.hpp).
inline const std::string kAnyName = "*";

/// Allowed values of a discriminator: a key whose value determines the other keys of its table, such as the
/// name of an effect.
struct Branch {
  std::vector<std::string> words;        ///< allowed words
  std::vector<std::string> titles = {};  ///< description of each word in the schema; empty: none
  std::string opened_by = {};  ///< key whose presence allows further words in the schema; empty: none
  bool any_case = false;       ///< whether case is ignored
};

/// TOML file that is read key by key.
class Config {
 public:
  /// Reads a file. Throws InputError if it cannot be read or is not TOML.
  explicit Config(const std::filesystem::path& file);
  /// Parses `text`. Messages cite `name` as the file, and relative paths refer to its folder. Throws
  /// InputError if the text is not TOML.
  Config(const std::string& text, const std::filesystem::path& name);
  /// Constructs a config without a file that records the keys that are read (base/describe.hpp). `trace`
  /// determines whether has() returns true. sound() returns false; raise() throws nothing.
  explicit Config(std::shared_ptr<KeyTrace> trace);

  /// Returns the value of a required key. T: bool, std::int64_t, double (integers are accepted), std::string,
  /// or a vector of the last three. Records a problem and returns T{} if the value is missing or wrong. The
  /// range applies to each number of a list.
  template <class T>
  T require(const std::string& key, const Range& range = {});
  /// Returns the value of a key, or `otherwise` if the key is missing or its value is wrong. Records a wrong
  /// value as a problem.
  template <class T>
  T optional(const std::string& key, T otherwise, const Range& range = {});
  /// Returns a text that must be one of `words`.
  std::string choice(const std::string& key, const std::vector<std::string>& words, const Range& about = {});
  /// Returns a text that must be one of `words`, or `otherwise` if the key is missing.
  std::string choice(const std::string& key, const std::vector<std::string>& words,
                     const std::string& otherwise, const Range& about = {});
  /// Returns a text that must be one of the branch's words and determines the other keys of its table.
  std::string branch(const std::string& key, const Branch& branch, const Range& about = {});
  /// Returns the path of a file; relative paths refer to the config's folder. Records a problem if no such
  /// file exists.
  std::filesystem::path file(const std::string& key, const Range& about = {});
  /// Returns an interval [low, high], low <= high.
  std::pair<double, double> interval(const std::string& key, const Range& range = {});

  /// Returns whether the config has the key.
  [[nodiscard]] bool has(const std::string& key) const;
  /// Returns whether the key's value is an array.
  [[nodiscard]] bool is_array(const std::string& key) const;
  /// Returns whether the key's value is a table.
  [[nodiscard]] bool is_table(const std::string& key) const;
  /// Returns whether the key's value is a text.
  [[nodiscard]] bool is_text(const std::string& key) const;
  /// Returns the keys of a table in alphabetical order; empty if there is no such table.
  [[nodiscard]] std::vector<std::string> keys(const std::string& table) const;
  /// Returns the keys of a table. A schema lists the keys `known`, and allows other keys only if the file has
  /// the key `opened_by`. The caller must check the returned keys.
  [[nodiscard]] std::vector<std::string> keys(const std::string& table, const std::vector<std::string>& known,
                                              const std::string& opened_by = {}) const;
  /// Returns the texts of a required list. A text may name a table at the same level as the key.
  std::vector<std::string> table_names(const std::string& key, const Range& about = {});
  /// Returns the place of a key's value, "file.toml:12:3". If the key is missing, returns the place of the
  /// innermost table around it, or the file's name if there is none.
  [[nodiscard]] std::string where(const std::string& key) const;
  /// Returns line and column of a key's value, {0, 0} if the key is missing.
  [[nodiscard]] std::pair<unsigned, unsigned> position(const std::string& key) const;
  /// Records a problem with a key's value.
  void problem(const std::string& key, const std::string& what, const std::string& why,
               const std::string& remedy);
  /// Records a problem if the config has `key`, which contradicts other keys.
  void exclude(const std::string& key, const std::string& what, const std::string& why,
               const std::string& remedy);
  /// Accepts a key or a table with any content, so that raise() does not report it as unknown.
  void ignore(const std::string& key);
  /// Whether no problem was recorded so far.
  [[nodiscard]] bool sound() const { return !trace_ && problems_.empty(); }
  /// Records every key that was never read as unknown, then throws InputError if there are problems.
  void raise();
  /// Returns the path of the config.
  [[nodiscard]] const std::filesystem::path& name() const { return name_; }

 private:
  struct Tree;
  template <class T>
  bool take(const std::string& key, T& value, const Range& range);
  std::filesystem::path name_;
  std::shared_ptr<Tree> tree_;
  std::shared_ptr<KeyTrace> trace_;  ///< record of the keys that are read; null if there is a file
  Problems problems_;
};

}  // namespace swingbank
