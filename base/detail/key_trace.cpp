#include "base/detail/key_trace.hpp"

#include <algorithm>

namespace swingbank {

namespace {
/// Returns the names in a key: "unit[0].model" -> "unit", "[0]", "model".
KeyPath parts_of(const std::string& key) {
  KeyPath parts(1);
  for (const char c : key) {
    if (c == '.' || c == '[') parts.emplace_back();
    if (c != '.') parts.back() += c;
  }
  return parts;
}
}  // namespace

std::string KeyDecision::id() const {
  std::string text = values.empty() ? "?" : "=";
  for (const auto& part : path) text += part + "\n";
  return text;
}

KeyPath KeyTrace::path_of(const std::string& key) const {
  KeyPath path;
  for (std::string& part : parts_of(key)) {
    if (const auto found = branches_.find(path); found != branches_.end())
      path.push_back("=" + found->second);
    path.push_back(part.starts_with('[') ? "[]" : std::move(part));
  }
  return path;
}

std::size_t KeyTrace::outcome(KeyDecision decision) {
  const auto found = outcomes_.find(decision.id());
  if (found != outcomes_.end()) decision.outcome = found->second;
  return decisions.emplace_back(std::move(decision)).outcome;
}

void KeyTrace::add(const std::string& key, KeyForm form, bool required) {
  KeyPath path = path_of(key);
  const bool needed = required && !optional.contains(path);
  keys.push_back({std::move(path), std::move(form), needed});
}

std::pair<double, double> KeyTrace::interval(const std::string& key, const Range& range) {
  add(key, {.type = "number", .list = true, .size = 2, .range = range, .words = {}}, true);
  return {0.0, 0.0};
}

std::string KeyTrace::word(const std::string& key, const std::vector<std::string>& words, const Range& about,
                           const std::string* otherwise) {
  KeyForm form{.type = "string", .range = about, .words = words};
  std::vector<std::string> all = words;
  if (otherwise != nullptr) {
    form.otherwise = *otherwise;
    std::erase(all, *otherwise);
    all.insert(all.begin(), *otherwise);
  }
  add(key, std::move(form), otherwise == nullptr);
  const std::size_t k = outcome(
      {path_of(key), std::vector<nlohmann::ordered_json>(all.begin(), all.end()), otherwise != nullptr});
  return all.at(k);
}

std::string KeyTrace::branch(const std::string& key, const Branch& branch, const Range& about) {
  if (branch.words.empty()) return {};
  add(key, {.type = "string", .range = about, .words = branch.words}, true);
  const KeyPath path = path_of(key), table(path.begin(), path.end() - 1);
  tables.push_back({table, path.back(), branch.words, branch.titles, branch.opened_by});
  const std::vector<nlohmann::ordered_json> values(branch.words.begin(), branch.words.end());
  const std::string word = branch.words.at(outcome({path, values, false, true}));
  branches_[table] = word;
  return word;
}

bool KeyTrace::present(const std::string& key) {
  const KeyPath parts = parts_of(key), path = path_of(key);
  for (const auto& part : parts)
    if (part.starts_with('[') && part != "[0]") return false;
  return path.back() == "[]" || outcome({path, {}, true}) == 0;
}

std::vector<std::string> KeyTrace::names(const std::string& table, const std::vector<std::string>& known,
                                         const std::string& opened_by) {
  if (!opened_by.empty()) tables.push_back({path_of(table), {}, known, {}, opened_by});
  for (const auto& name : known) optional.insert(path_of(table + "." + name));
  return known.empty() ? std::vector<std::string>{kAnyName} : known;
}

}  // namespace swingbank
