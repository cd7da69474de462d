#include "base/detail/key_tree.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank {
namespace {

using Json = KeyTree::Json;

Json number_of(double v) {
  constexpr double kExact = 1e15;  ///< largest integer that is written without exponent
  if (v == std::floor(v) && std::abs(v) <= kExact) return static_cast<std::int64_t>(v);
  return v;
}

Json schema_of(const KeyForm& form) {
  Json one = {{"type", form.type}};
  if (!form.words.empty()) one["enum"] = form.words;
  if (std::isfinite(form.range.low)) one["minimum"] = number_of(form.range.low);
  if (std::isfinite(form.range.high)) one["maximum"] = number_of(form.range.high);
  if (!form.range.pattern.empty()) one["pattern"] = form.range.pattern;
  if (form.list) {
    one = {{"type", "array"}, {"items", one}};
    if (form.size > 0) one["minItems"] = one["maxItems"] = form.size;
  }
  const std::string &unit = form.range.unit, &meaning = form.range.meaning;
  if (const std::string text =
          unit.empty() || unit == "-" ? meaning : meaning + (meaning.empty() ? "[" : " [") + unit + "]";
      !text.empty())
    one["description"] = text;
  if (!form.otherwise.is_null() && !form.varies) one["default"] = form.otherwise;
  return one;
}

/// Returns the schema of conditional alternatives: a value is validated against the alternative whose
/// condition it meets, so that an error names the key. `all`: requirements common to all alternatives.
/// `tables`: adds an anyOf with the alternatives' keys, for editors that do not evaluate conditions. Its
/// member {} accepts every value.
Json choose(const std::vector<std::pair<Json, Json>>& alternatives, Json all, bool tables) {
  Json any = Json::array({Json::object()}), conditions = Json::array();
  for (const auto& [condition, schema] : alternatives) {
    any.push_back(schema);
    conditions.push_back({{"if", condition}, {"then", schema}});
  }
  if (tables) conditions.insert(conditions.begin(), Json{{"anyOf", any}});
  all["allOf"] = conditions;
  return all;
}

/// Returns the schema of alternatives that the value's type distinguishes; an anyOf if two alternatives have
/// the same type.
Json choose_by_type(const Json& alternatives, bool tables) {
  if (alternatives.size() == 1) return alternatives.front();
  std::vector<std::pair<Json, Json>> by_type;
  Json types = Json::array();
  for (const Json& one : alternatives) {
    const std::string type = one.contains("type") && one["type"].is_string() ? one["type"] : Json("");
    const bool numbers = type == "number" || type == "integer";
    if (type.empty() || std::ranges::any_of(types, [&](const Json& t) {
          return t == type || (numbers && (t == "number" || t == "integer"));
        }))
      return {{"anyOf", alternatives}};
    types.push_back(type);
    by_type.emplace_back(Json{{"type", type}}, one);
  }
  return choose(by_type, {{"type", types}}, tables);
}

bool is_any(const std::string& name) { return name == kAnyName || name == "[]"; }
bool is_branch(const std::string& name) { return name.starts_with('='); }

}  // namespace

KeyTree& KeyTree::child(const std::string& name) {
  const auto found =
      std::ranges::find(children_, name, [](const auto& c) -> const std::string& { return c.first; });
  if (found != children_.end()) return *found->second;
  return *children_.emplace_back(name, std::make_unique<KeyTree>()).second;
}

KeyTree& KeyTree::at(const KeyPath& path) {
  KeyTree* node = this;
  for (const auto& name : path) node = &node->child(name);
  return *node;
}

void KeyTree::touch(int pass) {
  if (last_touched_ != pass) ++touched_;
  last_touched_ = pass;
}

void KeyTree::add(const KeyTrace& pass) {
  ++pass_;
  std::set<KeyPath> present;
  for (const KeyDecision& decision : pass.decisions)
    if (decision.values.empty() && decision.outcome == 0) present.insert(decision.path);
  for (const KeyTrace::Key& key : pass.keys) {
    KeyTree* node = this;
    std::vector<KeyTree*> way;
    for (const auto& name : key.path) {
      if (name != "[]") node->touch(pass_);
      node = &node->child(name);
      way.push_back(node);
    }
    const auto same = std::ranges::find_if(node->forms_, [&](const KeyForm& f) { return f.like(key.form); });
    if (same == node->forms_.end())
      node->forms_.push_back(key.form);
    else if (same->otherwise.is_null())
      same->otherwise = key.form.otherwise;
    else if (!key.form.otherwise.is_null() && key.form.otherwise != same->otherwise)
      same->varies = true;
    if (!key.required) continue;
    // A table with a required key is itself required, unless its name is arbitrary or it is an array element.
    // A key that is read only because it is present does not make its table required.
    for (std::size_t k = way.size(); k-- > 0 && !is_any(key.path[k]);) {
      if (way[k]->last_needed_ != pass_) ++way[k]->needed_;
      way[k]->last_needed_ = pass_;
      if (present.contains(key.path)) break;
    }
  }
  for (const KeyPath& path : present) at(path).asked_for_ = true;
  for (const KeyTrace::Table& table : pass.tables) {
    KeyTree& node = at(table.path);
    if (node.branch_.words.empty()) node.branch_ = table;
  }
}

void KeyTree::collect(const KeyPath& here, bool required, std::set<KeyPath>& into) const {
  for (const auto& [name, node] : children_) {
    KeyPath path = here;
    path.push_back(name);
    if (!required || (node->always(*this) && !node->asked_for_)) into.insert(path);
    node->collect(path, required, into);
  }
}

std::set<KeyPath> KeyTree::paths(bool required) const {
  std::set<KeyPath> all;
  collect({}, required, all);
  return all;
}

bool KeyTree::is_table() const {
  return std::ranges::any_of(children_, [](const auto& c) { return c.first != "[]"; });
}

Json KeyTree::forms() const {
  if (forms_.size() == 1) return schema_of(forms_.front());
  Json any = Json::array(), all = Json::object();
  for (const KeyForm& form : forms_) any.push_back(schema_of(form));
  if (any.front().contains("description")) all["description"] = any.front()["description"];
  for (Json& form : any)
    if (form.value("description", "") == all.value("description", "")) form.erase("description");
  all.update(choose_by_type(any, false));
  return all;
}

Json KeyTree::object(const std::vector<const KeyTree*>& parts, const std::string& word,
                     Json& definitions) const {
  Json properties = Json::object(), required = Json::array(), others = false, conditions = Json::array();
  for (const KeyTree* part : parts) {
    for (const auto& [name, node] : part->children_) {
      if (is_branch(name) || name == "[]") continue;
      if (name == kAnyName) {
        others = node->value(definitions);
        continue;
      }
      properties[name] = node->value(definitions);
      if (!word.empty() && part == this && node->is_table()) {  // a table common to all branches
        definitions[name] = properties[name];
        properties[name] = {{"$ref", "#/definitions/" + name}};
      }
      if (node->always(*part)) required.push_back(name);
    }
    for (const Json& condition : part->conditions_) conditions.push_back(condition);
  }
  if (!word.empty()) properties[branch_.key]["enum"] = Json::array({word});
  if (branch_.key.empty() && !branch_.opened_by.empty()) others = true;
  Json all = {{"type", "object"}, {"properties", properties}};
  if (!required.empty()) all["required"] = required;
  all["additionalProperties"] = others;
  if (!conditions.empty()) all["allOf"] = conditions;
  return all;
}

Json KeyTree::branches(Json& definitions) const {
  std::vector<std::pair<Json, Json>> alternatives;
  const auto is_word = [&](const std::string& word) {
    return Json{{"type", "object"},
                {"properties", {{branch_.key, {{"enum", Json::array({word})}}}}},
                {"required", Json::array({branch_.key})}};
  };
  for (std::size_t k = 0; k < branch_.words.size(); ++k) {
    const std::string& word = branch_.words[k];
    const auto found =
        std::ranges::find(children_, "=" + word, [](const auto& c) -> const std::string& { return c.first; });
    const KeyTree none;
    Json keys = object({this, found == children_.end() ? &none : found->second.get()}, word, definitions);
    if (k < branch_.titles.size()) keys["description"] = branch_.titles[k];
    std::string name = word;
    while (definitions.contains(name) && definitions[name] != keys) name += "_";
    definitions[name] = std::move(keys);
    alternatives.emplace_back(is_word(word), Json{{"$ref", "#/definitions/" + name}});
  }
  Json key = {{"type", "string"}};
  if (branch_.opened_by.empty()) key["enum"] = branch_.words;
  return choose(
      alternatives,
      {{"type", "object"}, {"properties", {{branch_.key, key}}}, {"required", Json::array({branch_.key})}},
      true);
}

Json KeyTree::value(Json& definitions) const {
  Json any = Json::array();
  if (!forms_.empty()) any.push_back(forms());
  if (is_table() || !branch_.opened_by.empty())
    any.push_back(branch_.key.empty() ? object({this}, "", definitions) : branches(definitions));
  for (const auto& [name, node] : children_)
    if (name == "[]") any.push_back({{"type", "array"}, {"items", node->value(definitions)}});
  return choose_by_type(any, true);
}

Json KeyTree::schema(Json& definitions) const { return object({this}, "", definitions); }

}  // namespace swingbank
