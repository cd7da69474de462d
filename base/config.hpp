#pragma once
// A strict TOML reader. Keys are dotted paths ("fault.start"). Every problem is collected with
// file:line:column and thrown together by raise(): missing keys, wrong types, values outside their range, and
// keys nobody asked for.
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

/// Allowed values of a number, ends included.
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  std::string unit = "";
};

class Config {
 public:
  /// Reads a file. Throws InputError if it cannot be read or is not TOML.
  explicit Config(const std::filesystem::path& file);
  /// Reads a text; `name` stands for the file in messages, relative paths refer to its folder.
  Config(const std::string& text, const std::filesystem::path& name);

  /// T: bool, std::int64_t, double (integers are taken too), std::string, or a vector of the last three. A
  /// missing or wrong value is noted and T{} returned. Ranges apply to each number.
  template <class T>
  T require(const std::string& key, const Range& range = {});
  template <class T>
  T optional(const std::string& key, T otherwise, const Range& range = {});
  /// One of the given words.
  std::string choice(const std::string& key, const std::vector<std::string>& words);
  std::string choice(const std::string& key, const std::vector<std::string>& words,
                     const std::string& otherwise);
  /// A file's path; relative ones refer to the config's folder. Notes a problem if there is no such file.
  std::filesystem::path file(const std::string& key);
  /// Two numbers, low <= high.
  std::pair<double, double> interval(const std::string& key, const Range& range = {});

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] bool is_array(const std::string& key) const;
  [[nodiscard]] bool is_text(const std::string& key) const;
  /// Names in a table, in order of the alphabet; empty if there is no such table.
  [[nodiscard]] std::vector<std::string> keys(const std::string& table) const;
  /// "file.toml:12:3" of a key, or of the file if it is not there.
  [[nodiscard]] std::string where(const std::string& key) const;
  /// Line and column of a key's value, {0, 0} if it is not there.
  [[nodiscard]] std::pair<unsigned, unsigned> position(const std::string& key) const;
  /// Notes a problem with a key's value.
  void problem(const std::string& key, const std::string& what, const std::string& why,
               const std::string& remedy);
  /// Takes a key or table as known, whatever it holds.
  void ignore(const std::string& key);
  [[nodiscard]] bool sound() const { return problems_.empty(); }
  /// Notes every key that was not asked for, then throws InputError if there are problems.
  void raise();
  [[nodiscard]] const std::filesystem::path& name() const { return name_; }

 private:
  struct Tree;
  template <class T>
  bool take(const std::string& key, T& value, const Range& range);
  std::filesystem::path name_;
  std::shared_ptr<Tree> tree_;
  Problems problems_;
};

}  // namespace swingbank
