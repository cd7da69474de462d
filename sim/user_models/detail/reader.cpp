#include "sim/user_models/detail/reader.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace swingbank::sim::user_models {
namespace {

struct Output {
  std::string_view name;
  Slot replaced,
      added;  ///< slots of a model that replaces the output or adds to it; machine: not allowed
};
constexpr std::array kUserModelOutputs = {
    Output{"Vc", Slot::compensator, Slot::compensator}, Output{"dVref", Slot::machine, Slot::setpoint},
    Output{"dPref", Slot::machine, Slot::setpoint},     Output{"Vs", Slot::stabiliser, Slot::stabiliser},
    Output{"Vlimiter", Slot::machine, Slot::limiter},   Output{"Efd", Slot::exciter, Slot::exciter},
    Output{"Tm", Slot::governor, Slot::shaft}};
constexpr std::size_t kMostStates = 40, kMostParameters = 100, kLargestFile = 100000;

}  // namespace

Reader::Reader(const std::string& text, const std::filesystem::path& name)
    : text_(text), file_(name.string()), config_(text, name) {}

/// Returns the names in a table in file order. Names that are not identifiers become problems and are
/// omitted.
std::vector<std::string> Reader::in_file_order(const std::string& table) {
  std::vector<std::string> list;
  for (const std::string& name : config_.keys(table)) {
    if (is_identifier(name)) {
      list.push_back(name);
      continue;
    }
    config_.ignore(table + "." + name);
    problems_.add("name '" + name + "' in " + table, config_.where(table),
                  "an expression cannot contain this name",
                  "use letters, digits and _, not beginning with a digit");
  }
  std::ranges::sort(list, {}, [&](const std::string& name) { return config_.position(table + "." + name); });
  return list;
}

/// Reserves a name for the entry at `key`. Returns false and adds a problem if the name is already in use.
bool Reader::claim(const std::string& key, const std::string& name, const char* what) {
  std::string why;
  const bool at_rest =
      name.size() > 1 && name.back() == '0' && signal_index(name.substr(0, name.size() - 1)) >= 0;
  if (signal_index(name) >= 0) why = "a signal of the plant has the name";
  if (at_rest) why = "it means the signal's value at the operating point";
  if (is_function(name)) why = "a function has the name";
  if (name == "pi" || name == "frequency" || name == "input")
    why = "it is reserved in files of user-defined models";
  if (const auto other = taken_.find(name); other != taken_.end())
    why = "a " + other->second + " has the name";
  if (why.empty()) {
    taken_.emplace(name, what);
    return true;
  }
  problems_.add(fmt::format("{} called {}", what, name), config_.where(key), why, "choose another name");
  config_.ignore(key);
  return false;
}

void Reader::read_head() {
  user_model_.name = config_.require<std::string>("name");
  if (config_.has("name") && !is_identifier(user_model_.name))
    problem("name", 0, "'" + user_model_.name + "'", "it is used in configs and on the command line",
            "use letters, digits and _, not beginning with a digit");
  user_model_.title = config_.require<std::string>("title");
  user_model_.source = config_.require<std::string>("source");
}

void Reader::read_entry_point() {
  std::vector<std::string> outputs;
  for (const Output& o : kUserModelOutputs) outputs.emplace_back(o.name);
  const std::string name = config_.choice("output", outputs);
  const bool replaces = config_.choice("action", {"replace", "add"}) == "replace";
  const auto* at = std::ranges::find(kUserModelOutputs, name, &Output::name);
  if (at == kUserModelOutputs.end()) at = &kUserModelOutputs.back();
  user_model_.replaces = replaces;
  user_model_.output = signal_index(at->name);
  user_model_.slot = replaces ? at->replaced : at->added;
  if (user_model_.slot != Slot::machine) return;
  user_model_.slot = at->added;
  problem("action", 0, "'replace' for " + name, "several effects and events add to it",
          "write action = \"add\"");
}

void Reader::read_parameters() {
  const auto names = in_file_order("parameters");
  if (names.size() > kMostParameters)
    problems_.add(fmt::format("{} parameters", names.size()), config_.where("parameters"),
                  fmt::format("at most {} are read", kMostParameters), "split the model");
  for (const std::string& name : names) {
    const std::string key = "parameters." + name + ".";
    if (!claim("parameters." + name, name, "parameter")) continue;
    const auto keep = [&](const std::string& text) -> std::string_view {
      return user_model_.texts.emplace_back(text);
    };
    Parameter p{};
    p.name = keep(name);
    p.symbol = keep(config_.optional<std::string>(key + "symbol", name));
    p.unit = keep(config_.require<std::string>(key + "unit"));
    p.low = config_.require<double>(key + "low");
    p.high = config_.require<double>(key + "high", {p.low});
    const Range range{p.low, std::max(p.low, p.high), std::string(p.unit)};
    p.default_value = config_.require<double>(key + "default", range);
    p.null_value = config_.has(key + "null_value")
                       ? config_.require<double>(key + "null_value", range)
                       : config_.optional<double>(key + "null_value", kNoNullValue);
    p.meaning = keep(config_.require<std::string>(key + "meaning"));
    const auto source = config_.optional<std::string>(key + "source", file_);
    p.default_from = p.bounds_from = literature::user_model(keep(source));
    parameter_.emplace(name, static_cast<int>(user_model_.parameters.size()));
    user_model_.parameters.push_back(p);
  }
  coefficients_ = kFirstParameter + static_cast<int>(user_model_.parameters.size());
}

void Reader::read_signals() {
  for (const std::string& name : in_file_order("signals")) {
    const std::string key = "signals." + name;
    if (!claim(key, name, "signal")) continue;
    if (auto e = expression(key))
      named_.emplace(name, Named{Named::Kind::signal, std::move(*e)});
    else
      taken_.erase(name);
  }
}

void Reader::read_references() {
  for (const std::string& name : in_file_order("references")) {
    const std::string key = "references." + name;
    if (!claim(key, name, "reference")) continue;
    if (config_.is_text(key) && config_.require<std::string>(key) == "solve") {
      user_model_.searched.push_back(coefficients_);
      searched_.emplace(name, graph_.solved(coefficients_++));
      if (!user_model_.must_meet())
        problem(key, 0, "'solve'",
                fmt::format("the operating point does not prescribe {}", user_model_.output_name()),
                "give an expression of parameters and values at the operating point");
      else if (user_model_.searched.size() > 1)
        problem(key, 0, "a second 'solve'", "the output determines only one reference",
                "give this reference as an expression");
    } else if (auto e = expression(key)) {
      named_.emplace(name, Named{Named::Kind::reference, std::move(*e)});
    }
  }
}

/// Returns the weight at `key` of a state's error in step size control (State::weight).
double Reader::state_weight(const std::string& key) {
  return config_.optional<double>(key + "weight", 1.0, {1e-6, 1e6, ""});
}

/// Reads the states. Their derivatives are read later, by read_output(), so that they may use any state.
void Reader::read_states() {
  const auto names = in_file_order("states");
  for (const std::string& name : names) {
    const std::string key = "states." + name + ".";
    if (!claim("states." + name, name, "state")) continue;
    const int index = add_state(name, config_.require<std::string>(key + "meaning"));
    StateEntry& s = states_[static_cast<std::size_t>(index)];
    s.unit = config_.require<std::string>(key + "unit");
    s.weight = state_weight(key);
    state_.emplace(name, index);
  }
  for (const auto& [name, index] : state_) {
    const std::string key = "states." + name + ".";
    const auto at = static_cast<std::size_t>(index);
    if (config_.has(key + "low")) states_[at].low = value(key + "low");
    if (config_.has(key + "high")) states_[at].high = value(key + "high");
    states_[at].start = value(key + "start", 0.0);
    if (!graph_[states_[at].start].fixed)
      problem(key + "start", 0, "a start value that varies during the run", "it is needed before the run",
              "use parameters and values at the operating point");
  }
}

void Reader::read_requirements() {
  if (config_.has("require")) {
    const auto texts = config_.require<std::vector<std::string>>("require");
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const std::string key = fmt::format("require[{}]", i);
      Fault fault;
      const Tree tree = parse_condition(texts[i], fault);
      if (!tree) {
        problem(key, fault.at, fault.what, fault.why, fault.remedy);
        continue;
      }
      const int a = lower(tree->arguments[0], key), b = lower(tree->arguments[1], key);
      if (!graph_[a].parameters || !graph_[b].parameters)
        problem(key, 0, "a requirement on more than parameters", "it is checked before the run",
                "use parameters only");
      user_model_.requirements.push_back({tree->op, -1, -1, texts[i], place(key, 0)});
      requirement_vertices_.emplace_back(a, b);
    }
  }
  if (!config_.has("switching_times")) return;
  const auto texts = config_.require<std::vector<std::string>>("switching_times");
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::string key = fmt::format("switching_times[{}]", i);
    Fault fault;
    const Tree tree = parse_value(texts[i], fault);
    if (!tree) {
      problem(key, fault.at, fault.what, fault.why, fault.remedy);
      continue;
    }
    switching_time_vertices_.push_back(lower(tree, key));
    if (!graph_[switching_time_vertices_.back()].parameters)
      problem(key, 0, "a switching time that is not known before the run", "the integration is split there",
              "use parameters only");
  }
}

void Reader::read_output() {
  output_ = config_.has("value") || last_in_chain_.empty()
                ? value("value")
                : look_up(Node{Op::name, 0.0, last_in_chain_, {}, 0}, "chain");
  for (const auto& [name, index] : state_) {
    own_ = index;
    const int derivative = value("states." + name + ".derivative");
    own_ = -1;
    states_[static_cast<std::size_t>(index)].derivative = derivative;
  }
  for (const std::string& name : block_order_)
    if (blocks_.contains(name)) finish_block(name);
  for (auto& [name, entry] : named_)  // unused entries are checked as well
    (void)named(Node{Op::name, 0.0, name, {}, 0}, "value", entry);
  for (StateEntry& s : states_)
    for (const int limit : {s.low, s.high})
      if (limit >= 0 && !graph_[limit].fixed)
        problems_.add("limit of state " + s.name, config_.name().string(),
                      "the limits of a state are fixed during a run",
                      "use parameters and values at the operating point, or clamp the output");
  if (states_.size() > kMostStates)
    problems_.add(fmt::format("{} states", states_.size()), config_.name().string(),
                  fmt::format("at most {} are read", kMostStates), "split the model");
}

std::string Reader::describe() const {
  std::string text = "\n";
  const std::string sign = user_model_.replaces ? " = " : " = ... + ";
  for (const Expression& e : read_) {
    std::string left = e.key;
    if (left.starts_with("states.") && left.ends_with(".derivative"))
      left = "d" + left.substr(7, left.size() - 18) + "/dt";
    else if (left.starts_with("signals.") || left.starts_with("references."))
      left = left.substr(left.find('.') + 1);
    else if (left == "value")
      left = user_model_.output_name();
    text += fmt::format("  {}{}{}\n", left, e.key == "value" ? sign : " = ", e.text);
  }
  for (const std::string& name : block_order_) {
    const auto block = blocks_.find(name);
    if (block != blocks_.end()) text += fmt::format("  block {}: {}\n", name, block->second.kind);
  }
  if (!last_in_chain_.empty())
    text += fmt::format("  {}{}{}\n", user_model_.output_name(), sign, last_in_chain_);
  return text;
}

/// Returns true for an exciter with limits, none of which belongs to a state (State::bends).
bool Reader::bends() const {
  constexpr std::array kBending = {Act::minimum, Act::maximum, Act::clamp, Act::select_less,
                                   Act::select_less_equal};
  const auto limited = [](const StateEntry& s) { return s.low >= 0 || s.high >= 0; };
  return user_model_.slot == Slot::exciter && std::ranges::none_of(states_, limited) &&
         std::ranges::any_of(graph_.vertices(), [&](const Vertex& v) {
           return !v.fixed && std::ranges::find(kBending, v.act) != kBending.end();
         });
}

/// Builds records and program; requires a file without errors.
void Reader::finish() {
  std::vector<int> derivatives, also;
  for (const StateEntry& s : states_) {
    derivatives.push_back(s.derivative);
    for (const int v : {s.low, s.high, s.start})
      if (v >= 0) also.push_back(v);
  }
  for (const auto& [a, b] : requirement_vertices_) also.insert(also.end(), {a, b});
  also.insert(also.end(), switching_time_vertices_.begin(), switching_time_vertices_.end());
  user_model_.code = compile(graph_, derivatives, output_, also, coefficients_);
  const auto coefficient = [&](int vertex) {
    return vertex < 0 ? -1 : user_model_.code.coefficient_of[static_cast<std::size_t>(vertex)];
  };
  for (const StateEntry& s : states_) {
    State record;
    record.name = user_model_.texts.emplace_back(s.name);
    record.unit = user_model_.texts.emplace_back(s.unit);
    record.meaning = user_model_.texts.emplace_back(s.meaning);
    record.weight = s.weight;
    record.low = coefficient(s.low);
    record.high = coefficient(s.high);
    record.bends = bends();
    user_model_.states.push_back(record);
    user_model_.start.push_back(coefficient(s.start));
  }
  for (std::size_t i = 0; i < requirement_vertices_.size(); ++i) {
    user_model_.requirements[i].left = coefficient(requirement_vertices_[i].first);
    user_model_.requirements[i].right = coefficient(requirement_vertices_[i].second);
  }
  for (const int v : switching_time_vertices_) user_model_.switching_times.push_back(coefficient(v));
  for (const auto& [key, vertex] : values_) {
    const int index = coefficient(vertex);
    if (index >= 0 && graph_[vertex].parameters) user_model_.finite.emplace_back(index, key);
  }
  for (std::size_t v = 0; v < graph_.vertices().size(); ++v) {
    const Vertex& vertex = graph_[static_cast<int>(v)];
    const int index = user_model_.code.coefficient_of[v];
    if (index >= 0 && vertex.parameters && vertex.act != Act::coefficient)
      user_model_.finite.emplace_back(index, "a value computed from the parameters");
  }
}

Definition Reader::read() {
  if (text_.size() > kLargestFile)
    throw InputError({fmt::format("a user-defined model of {} bytes", text_.size()), config_.name().string(),
                      fmt::format("at most {} are read", kLargestFile), "shorten it"});
  read_head();
  read_entry_point();
  user_model_.description = config_.optional<std::string>("diagram", "");
  try {
    read_parameters();
    read_references();
    read_signals();
    read_blocks();
    read_states();
    read_requirements();
    read_output();
    try {
      config_.raise();
    } catch (const InputError& e) {
      problems_.add(e);
    }
    problems_.raise();
    finish();
  } catch (const TooLarge&) {
    throw InputError({"user-defined model too large", config_.name().string(),
                      fmt::format("its expressions have at most {} values, {} of them in use at once",
                                  Graph::kMost, kRegisters),
                      "simplify it"});
  }
  user_model_.description += describe();
  return std::move(user_model_);
}

Definition read_definition(const std::string& text, const std::filesystem::path& name) {
  Definition user_model = Reader(text, name).read();
  user_model.text = text;
  return user_model;
}

}  // namespace swingbank::sim::user_models
