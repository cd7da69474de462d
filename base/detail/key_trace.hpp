#pragma once
// Keys that a reader asks for in one pass over a config without a file, and the decisions that it makes on
// the way.
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

/// Path of a key: names of tables and key; "*" any name, "[]" the elements of an array, "=WORD" the keys of a
/// table whose branch is WORD.
using KeyPath = std::vector<std::string>;

/// Allowed values of a key.
struct KeyForm {
  std::string type;  ///< type of JSON Schema
  bool list = false;
  std::size_t size = 0;  ///< number of elements of a list; 0: any
  Range range;
  std::vector<std::string> words;      ///< allowed texts; empty: all
  nlohmann::ordered_json otherwise{};  ///< value where the key is missing; null: unknown
  bool varies = false;                 ///< passes differ in that value
  /// Whether the forms are equal but for the value of a missing key.
  [[nodiscard]] bool like(const KeyForm& other) const {
    return type == other.type && list == other.list && size == other.size && words == other.words &&
           range.low == other.range.low && range.high == other.range.high && range.unit == other.range.unit &&
           range.meaning == other.range.meaning && range.pattern == other.range.pattern;
  }
};

/// Property of a file whose outcome determines which keys the reader asks for next.
struct KeyDecision {
  KeyPath path;  ///< key
  std::vector<nlohmann::ordered_json>
      values;               ///< values of the key; empty: whether it is present, or missing
  bool otherwise = false;   ///< the first value is that of a missing key
  bool branch = false;      ///< every value has keys of its own
  std::size_t outcome = 0;  ///< given outcome
  [[nodiscard]] std::size_t outcomes() const { return values.empty() ? 2 : values.size(); }
  [[nodiscard]] std::string id() const;
};

/// One pass of a reader. Outcomes are numbered from 0; a presence is 0: present, 1: missing.
class KeyTrace {
 public:
  struct Key {
    KeyPath path;
    KeyForm form;
    bool required;
  };
  /// Table whose keys depend on the branch, or have any name.
  struct Table {
    KeyPath path;
    std::string key;                         ///< key of the branch; empty: none
    std::vector<std::string> words, titles;  ///< its words with their titles
    std::string opened_by;                   ///< key beside which other words or names are possible
  };
  /// `outcomes`: outcomes by decision, 0 where none is given. `arrays`: whether values of more than one kind
  /// are arrays or texts.
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
  std::set<KeyPath> optional;  ///< keys of names(), which may be missing

 private:
  [[nodiscard]] KeyPath path_of(const std::string& key) const;
  std::size_t outcome(KeyDecision decision);
  void add(const std::string& key, KeyForm form, bool required);
  std::map<std::string, std::size_t> outcomes_;
  bool arrays_;
  std::map<KeyPath, std::string> branches_;  ///< word of each table with a branch
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
