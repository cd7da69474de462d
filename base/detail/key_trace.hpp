#pragma once
// Record of a dry run of a config-reading function, for which no file exists: the keys that it asks for, and
// its decisions.
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/config.hpp"
#include "base/json.hpp"

namespace swingbank {

/// Path of a key: the names of the tables and the key. "*" is any name, and "[]" any element of an array.
/// "=WORD" denotes the keys of a table whose discriminator (Branch) has the value WORD.
using KeyPath = std::vector<std::string>;

/// Allowed values of a key.
struct KeyForm {
  std::string type;  ///< type of JSON Schema
  bool list = false;
  std::size_t size = 0;  ///< number of elements of a list; 0: any
  Range range;
  std::vector<std::string> words;      ///< allowed texts; empty: all
  nlohmann::ordered_json otherwise{};  ///< default value; null: unknown
  bool varies = false;                 ///< whether the default differs between calls of the reader
  /// Returns whether the forms are equal except for the default value.
  [[nodiscard]] bool like(const KeyForm& other) const {
    return type == other.type && list == other.list && size == other.size && words == other.words &&
           range.low == other.range.low && range.high == other.range.high && range.unit == other.range.unit &&
           range.meaning == other.range.meaning && range.pattern == other.range.pattern;
  }
};

/// Question about a file, whose answer determines which keys the reader asks for next.
struct KeyDecision {
  KeyPath path;  ///< key
  std::vector<nlohmann::ordered_json>
      values;               ///< values of the key; empty: the decision is whether the key is present
  bool otherwise = false;   ///< whether a missing key counts as the first value
  bool branch = false;      ///< whether each value has its own keys
  std::size_t outcome = 0;  ///< outcome in the recorded call of the reader
  [[nodiscard]] std::size_t outcomes() const { return values.empty() ? 2 : values.size(); }
  [[nodiscard]] std::string id() const;
};

/// Record of one pass: one call of the config-reading function. Outcomes are numbered from 0. For the
/// presence of a key, 0 is present and 1 missing.
class KeyTrace {
 public:
  struct Key {
    KeyPath path;
    KeyForm form;
    bool required;
  };
  /// Table whose keys depend on a discriminator, or have arbitrary names.
  struct Table {
    KeyPath path;
    std::string key;                         ///< discriminator; empty: none
    std::vector<std::string> words, titles;  ///< its values and their descriptions
    std::string opened_by;                   ///< key whose presence allows words or names that are not listed
  };
  /// `outcomes`: outcome of each decision by its id; a missing one is 0. `arrays`: true if a value that may
  /// be a table, an array or a text is read as an array or text, false if it is read as a table.
  KeyTrace(std::map<std::string, std::size_t> outcomes, bool arrays)
      : outcomes_(std::move(outcomes)), arrays_(arrays) {}

  template <class T>
  T leaf(const std::string& key, bool required, const Range& range, const T* otherwise = nullptr);
  std::pair<double, double> interval(const std::string& key, const Range& range);
  std::string word(const std::string& key, const std::vector<std::string>& words, const Range& about,
                   const std::string* otherwise);
  std::string branch(const std::string& key, const Branch& branch, const Range& about);
  bool present(const std::string& key);
  std::vector<std::string> names(const std::string& table, const std::vector<std::string>& known,
                                 const std::string& opened_by);
  [[nodiscard]] bool arrays() const { return arrays_; }

  std::vector<Key> keys;
  std::vector<KeyDecision> decisions;
  std::vector<Table> tables;
  std::set<KeyPath> optional;  ///< keys that names() returned; they may be missing

 private:
  [[nodiscard]] KeyPath path_of(const std::string& key) const;
  std::size_t outcome(KeyDecision decision);
  void add(const std::string& key, KeyForm form, bool required);
  std::map<std::string, std::size_t> outcomes_;
  bool arrays_;
  std::map<KeyPath, std::string> branches_;  ///< value of the discriminator, by table
};

template <class T>
struct KeyType;
template <>
struct KeyType<bool> {
  static constexpr const char* name = "boolean";
};
template <>
struct KeyType<std::int64_t> {
  static constexpr const char* name = "integer";
};
template <>
struct KeyType<double> {
  static constexpr const char* name = "number";
};
template <>
struct KeyType<std::string> {
  static constexpr const char* name = "string";
};
template <class T>
struct KeyType<std::vector<T>> : KeyType<T> {};

template <class T>
T KeyTrace::leaf(const std::string& key, bool required, const Range& range, const T* otherwise) {
  KeyForm form{.type = KeyType<T>::name, .range = range, .words = {}};
  if constexpr (!std::is_arithmetic_v<T> && !std::is_same_v<T, std::string>) form.list = true;
  if (otherwise != nullptr) {
    bool given = true;
    if constexpr (std::is_same_v<T, bool>)
      given = true;
    else if constexpr (std::is_arithmetic_v<T>)
      given = *otherwise >= range.low && *otherwise <= range.high &&
              std::isfinite(static_cast<double>(*otherwise));
    else
      given = !otherwise->empty();
    if (given) form.otherwise = *otherwise;
  }
  add(key, std::move(form), required);
  T value = otherwise != nullptr ? *otherwise : T{};
  if constexpr (std::is_same_v<T, bool>)
    value = outcome({path_of(key), {value, !value}, otherwise != nullptr}) == 0 ? value : !value;
  return value;
}

}  // namespace swingbank
