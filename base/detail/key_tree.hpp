#pragma once
// Tree of the keys for which a config-reading function asks, collected over several calls of it
// (key_trace.hpp) and written as JSON Schema.
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/detail/key_trace.hpp"

namespace swingbank {

/// Node of the tree, a table or a key, with the results of all passes (calls of the config-reading function).
class KeyTree {
 public:
  using Json = nlohmann::ordered_json;
  KeyTree() = default;
  explicit KeyTree(const std::vector<const KeyTrace*>& passes) {
    for (const KeyTrace* pass : passes) add(*pass);
  }
  /// Adds the keys of one pass.
  void add(const KeyTrace& pass);
  /// Adds a condition to the table at `path`.
  void constrain(const KeyPath& path, Json condition) {
    at(path).conditions_.push_back(std::move(condition));
  }
  /// Returns the paths of all tables and keys.
  [[nodiscard]] std::set<KeyPath> asked() const { return paths(false); }
  /// Returns the paths of the tables and keys that are required in every pass that reads their table.
  [[nodiscard]] std::set<KeyPath> required() const { return paths(true); }
  /// Returns the schema of the table; schemas of branches are added to `definitions`.
  [[nodiscard]] Json schema(Json& definitions) const;

 private:
  KeyTree& at(const KeyPath& path);
  KeyTree& child(const std::string& name);
  void touch(int pass);
  void collect(const KeyPath& here, bool required, std::set<KeyPath>& into) const;
  [[nodiscard]] std::set<KeyPath> paths(bool required) const;
  [[nodiscard]] bool always(const KeyTree& table) const { return needed_ > 0 && needed_ == table.touched_; }
  [[nodiscard]] bool is_table() const;
  [[nodiscard]] Json value(Json& definitions) const;
  [[nodiscard]] Json forms() const;
  [[nodiscard]] Json object(const std::vector<const KeyTree*>& parts, const std::string& word,
                            Json& definitions) const;
  [[nodiscard]] Json branches(Json& definitions) const;

  std::vector<std::pair<std::string, std::unique_ptr<KeyTree>>> children_;  ///< in the order of reading
  std::vector<KeyForm> forms_;
  std::vector<Json> conditions_;
  KeyTrace::Table branch_;
  bool asked_for_ = false;              ///< whether a reader asks first whether the key is present
  int pass_ = 0;                        ///< number of passes so far; used in the root
  int touched_ = 0, last_touched_ = 0;  ///< count of passes that read this table; index of the last one
  int needed_ = 0, last_needed_ = 0;    ///< count of passes that require this node; index of the last one
};

}  // namespace swingbank
