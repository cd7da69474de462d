#include "base/describe.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include "base/detail/key_tree.hpp"
#include "base/schema_text.hpp"

namespace swingbank {
namespace {

using Json = nlohmann::ordered_json;
using Passes = std::vector<const KeyTrace*>;
using Outcomes = std::map<std::string, std::size_t>;
using Paths = std::set<KeyPath>;

bool begins_with(const KeyPath& path, const KeyPath& with) {
  return path.size() >= with.size() && std::equal(with.begin(), with.end(), path.begin());
}
KeyPath table_of(const KeyPath& key) { return {key.begin(), key.end() - 1}; }
KeyPath below(const KeyPath& path, const KeyPath& table) {
  return {path.begin() + static_cast<std::ptrdiff_t>(table.size()), path.end()};
}
bool is_single(const KeyPath& path) {
  return std::ranges::none_of(path, [](const auto& name) { return name == kAnyName || name == "[]"; });
}

/// Returns the schema `inner` of the table that contains the key `path`, rewritten as a schema of the root
/// table.
Json nested(const KeyPath& path, Json inner, bool present) {
  for (std::size_t k = path.size() - 1; k-- > 0;) {
    if (path[k] == kAnyName) {
      inner = {{"additionalProperties", std::move(inner)}};
    } else if (path[k] == "[]") {
      inner = {{"items", std::move(inner)}};
    } else if (!path[k].starts_with('=')) {
      inner = {{"properties", {{path[k], std::move(inner)}}}};
      if (present) inner["required"] = Json::array({path[k]});
    }
  }
  return inner;
}
Json with_key(const KeyPath& path, bool present) {
  return nested(path, {{"required", Json::array({path.back()})}}, present);
}
Json without_key(const KeyPath& path) {
  return nested(path, {{"properties", {{path.back(), false}}}}, false);
}
Json negated(const Json& schema) { return schema.contains("not") ? schema["not"] : Json{{"not", schema}}; }

Json all_of(const Json& schemas) { return schemas.size() == 1 ? schemas.front() : Json{{"allOf", schemas}}; }

/// Returns the condition that the decision has one of the outcomes; `path` is its key relative to the table.
Json has_outcome(const KeyDecision& decision, const KeyPath& path, const std::vector<std::size_t>& outcomes) {
  if (decision.values.empty())
    return outcomes.front() == 0 ? with_key(path, true) : negated(with_key(path, true));
  const bool missing = decision.otherwise && std::ranges::count(outcomes, 0U) > 0;
  Json values = Json::array();
  for (std::size_t k = 0; k < decision.values.size(); ++k)
    if ((std::ranges::count(outcomes, k) > 0) != missing) values.push_back(decision.values[k]);
  const Json given = nested(
      path, {{"properties", {{path.back(), {{"enum", values}}}}}, {"required", Json::array({path.back()})}},
      true);
  return missing ? negated(given) : given;
}

struct Decided {
  KeyDecision decision;
  std::size_t outcome;
};

/// Keys that become required, and keys that become invalid, for a given set of a decision's outcomes.
struct Consequence {
  Paths required, unknown;
  std::vector<std::size_t> outcomes;
};

/// Runs the config-reading function for every outcome of every decision. A decision is a key whose value
/// changes which keys are read. Its outcomes are tried in the first context (outcomes of other decisions) in
/// which the key is read.
class Explorer {
 public:
  explicit Explorer(const std::function<void(Config&)>& read) : read_(read) {}

  Json schema(const std::string& title) {
    explore({}, {});
    Passes all;
    for (const auto& pass : passes_) all.push_back(pass.get());
    tree_ = KeyTree(all);
    for (const auto& group : groups_) constrain(group);
    open_tables();
    Json definitions = Json::object();
    Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    schema.update(tree_.schema(definitions));
    if (!definitions.empty()) schema["definitions"] = definitions;
    return schema;
  }

 private:
  struct Group {
    KeyDecision decision;
    std::vector<Decided> context;
    std::vector<Passes> passes;  ///< by outcome
  };

  /// Calls the reader with these outcomes, then with every other outcome of each new decision. Returns the
  /// records of all calls.
  Passes explore(const Outcomes& outcomes, const std::vector<Decided>& context) {
    Passes own;
    std::vector<KeyDecision> fresh;
    for (const bool arrays : {false, true}) {
      const auto trace = std::make_shared<KeyTrace>(outcomes, arrays);
      Config config(trace);
      read_(config);
      passes_.push_back(trace);
      own.push_back(trace.get());
      for (const KeyDecision& decision : trace->decisions)
        if (seen_.insert(decision.id()).second) fresh.push_back(decision);
    }
    Passes all = own;
    for (const KeyDecision& decision : fresh) {
      std::vector<Passes> by_outcome = {own};
      for (std::size_t k = 1; k < decision.outcomes(); ++k) {
        Outcomes other = outcomes;
        other[decision.id()] = k;
        std::vector<Decided> inner = context;
        inner.push_back({decision, k});
        by_outcome.push_back(explore(other, inner));
        all.insert(all.end(), by_outcome.back().begin(), by_outcome.back().end());
      }
      if (!decision.branch) groups_.push_back({decision, context, std::move(by_outcome)});
    }
    return all;
  }

  /// Adds the consequences of one decision's outcomes to the tree, as conditions of the schema.
  void constrain(const Group& group) {
    const std::vector<Consequence> all = consequences(group);
    if (std::ranges::all_of(all, [](const auto& c) { return c.required.empty() && c.unknown.empty(); }))
      return;
    KeyPath table = table_of(group.decision.path);
    for (const Consequence& c : all)
      for (const Paths* paths : {&c.required, &c.unknown})
        for (const KeyPath& path : *paths)
          while (!begins_with(path, table)) table.pop_back();
    const KeyPath key = below(group.decision.path, table);
    Json context = Json::array();
    for (const Decided& a : group.context) {
      if (!begins_with(a.decision.path, table)) continue;  // implied by the presence of the table
      const KeyPath path = below(a.decision.path, table);
      if (!is_single(path)) return;
      context.push_back(has_outcome(a.decision, path, {a.outcome}));
    }
    if (!is_single(key)) return;
    // One condition per consequence, so that a validator's error names the key instead of all alternatives.
    for (const Consequence& c : all) {
      Json follows = Json::array();
      std::map<KeyPath, Json> together;  // required keys by their table
      for (const KeyPath& p : c.required) together[table_of(p)].push_back(p.back());
      for (const auto& [of, keys] : together) {
        KeyPath any_key = below(of, table);
        any_key.emplace_back();
        follows.push_back(nested(any_key, {{"required", keys}}, false));
      }
      for (const KeyPath& p : c.unknown) follows.push_back(without_key(below(p, table)));
      if (follows.empty()) continue;
      Json decided = context;
      decided.push_back(has_outcome(group.decision, key, c.outcomes));
      tree_.constrain(table, {{"if", all_of(decided)}, {"then", all_of(follows)}});
    }
  }

  /// Returns the consequences of a decision's outcomes; outcomes with the same consequences are grouped.
  static std::vector<Consequence> consequences(const Group& group) {
    std::vector<Paths> required, asked;
    Paths any_asked;
    for (const Passes& passes : group.passes) {
      const KeyTree tree(passes);
      required.push_back(tree.required());
      asked.push_back(tree.asked());
      any_asked.insert(asked.back().begin(), asked.back().end());
    }
    // If an outcome does not read a table, the keys of that table are not counted as missing.
    const auto always = [&](const KeyPath& path) {
      const KeyPath table = table_of(path);
      for (std::size_t k = 0; k < required.size(); ++k)
        if (!required[k].contains(path) && (table.empty() || asked[k].contains(table))) return false;
      return true;
    };
    std::vector<Consequence> all;
    for (std::size_t k = 0; k < group.passes.size(); ++k) {
      Consequence c{{}, {}, {k}};
      for (const KeyPath& path : required[k])
        if (depends(path, group.decision.path) && !always(path)) c.required.insert(path);
      for (const KeyPath& path : any_asked)
        if (depends(path, group.decision.path) && !asked[k].contains(path) && !is_unknown(c.unknown, path))
          c.unknown.insert(path);
      const auto same = std::ranges::find_if(
          all, [&](const auto& o) { return o.required == c.required && o.unknown == c.unknown; });
      if (same == all.end())
        all.push_back(std::move(c));
      else
        same->outcomes.push_back(k);
    }
    return all;
  }

  /// Returns whether a key may depend on a decision: it is not the decision's key or below it, and each
  /// branch (Branch) that contains it also contains the decision.
  static bool depends(const KeyPath& path, const KeyPath& decision) {
    if (begins_with(path, decision) || !is_single({path.back()}) || path.back().starts_with('='))
      return false;
    for (std::size_t i = 0; i < path.size(); ++i)
      if (path[i].starts_with('=') && (i + 1 >= decision.size() || decision[i] != path[i])) return false;
    return true;
  }

  /// Returns whether any parent table of the key is itself unknown.
  static bool is_unknown(const Paths& unknown, const KeyPath& path) {
    for (KeyPath table = table_of(path); !table.empty(); table.pop_back())
      if (unknown.contains(table)) return true;
    return false;
  }

  /// Adds the condition: an unlisted enum value or name requires the key `opened_by`.
  void open_tables() {
    std::map<KeyPath, KeyTrace::Table> tables;
    for (const auto& pass : passes_)
      for (const KeyTrace::Table& table : pass->tables)
        if (!table.opened_by.empty()) tables.emplace(table.path, table);
    std::map<std::string, Json> closed;
    for (const auto& [place, table] : tables) {
      KeyPath path = place;
      path.push_back(table.key);
      Json known = {{"properties", {{table.key, {{"enum", table.words}}}}}};
      if (table.key.empty()) {
        known = {{"properties", Json::object()}, {"additionalProperties", false}};
        for (const auto& word : table.words) known["properties"][word] = Json::object();
      }
      closed.try_emplace(table.opened_by, Json::array()).first->second.push_back(nested(path, known, false));
    }
    for (const auto& [key, conditions] : closed)
      tree_.constrain({}, {{"if", negated(with_key({key}, true))}, {"then", all_of(conditions)}});
  }

  const std::function<void(Config&)>& read_;
  std::vector<std::shared_ptr<KeyTrace>> passes_;
  std::set<std::string> seen_;
  std::vector<Group> groups_;
  KeyTree tree_;
};

}  // namespace

std::string describe_keys(const std::string& title, const std::function<void(Config&)>& read) {
  return schema_text(Explorer(read).schema(title));
}

}  // namespace swingbank
