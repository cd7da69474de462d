// Resolution of the expressions of a user-defined model: their positions in the file and the meaning of their
// names.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/constants.hpp"
#include "sim/user_models/detail/reader.hpp"

namespace swingbank::sim::user_models {

/// Returns file:line:column of the character `offset` after the opening quote of the expression at `key`.
std::string Reader::place(const std::string& key, std::size_t offset) const {
  auto [line, column] = config_.position(key);
  if (line == 0) return config_.where(key);
  std::size_t at = 0;
  for (unsigned i = 1; i < line && at != std::string::npos; ++i) {
    at = text_.find('\n', at);
    if (at != std::string::npos) ++at;
  }
  if (at == std::string::npos || at + column - 1 >= text_.size()) return config_.where(key);
  at += column - 1;
  const bool triple = text_.compare(at, 3, "\"\"\"") == 0 || text_.compare(at, 3, "'''") == 0;
  std::size_t skip = triple ? 3 : 1;
  if (triple && text_.compare(at + skip, 1, "\n") == 0) ++skip;
  for (std::size_t i = 0; i < skip + offset && at < text_.size(); ++i, ++at) {
    ++column;
    if (text_[at] == '\n') ++line, column = 1;
  }
  return fmt::format("{}:{}:{}", config_.name().string(), line, column);
}

void Reader::problem(const std::string& key, std::size_t offset, std::string what, std::string why,
                     std::string remedy) {
  problems_.add(fmt::format("{} in {}", what, key), place(key, offset), std::move(why), std::move(remedy));
}

/// Parses the expression at `key`, which may be a number. Returns none and adds a problem if it is missing or
/// invalid.
std::optional<Expression> Reader::expression(const std::string& key, bool condition) {
  constexpr std::size_t kLongestText = 10000;
  Expression e{key, {}, nullptr};
  if (config_.has(key) && !config_.is_text(key)) {
    const auto number = config_.require<double>(key);
    e.text = fmt::format("{}", number);
    e.tree = std::make_shared<Node>(Node{Op::number, number, {}, {}, 0});
    read_.push_back(e);
    return e;
  }
  e.text = config_.require<std::string>(key);
  if (!config_.is_text(key)) return {};
  Fault fault;
  if (e.text.size() > kLongestText)
    fault = {0, fmt::format("{} characters", e.text.size()), fmt::format("at most {} are read", kLongestText),
             "split it with [signals]"};
  else
    e.tree = condition ? parse_condition(e.text, fault) : parse_value(e.text, fault);
  if (!e.tree) {
    problem(key, fault.at, fault.what, fault.why, fault.remedy);
    return {};
  }
  read_.push_back(e);
  return e;
}

/// Returns the vertex of the value at `key`, or of `otherwise` if it is missing.
int Reader::value(const std::string& key, std::optional<double> otherwise) {
  if (otherwise && !config_.has(key)) {
    config_.ignore(key);
    return graph_.constant(*otherwise);
  }
  if (const auto known = values_.find(key); known != values_.end()) return known->second;
  const auto e = expression(key);
  const int vertex = e ? lower(e->tree, key) : graph_.constant(0.0);
  return values_[key] = vertex;
}

namespace {
/// Operations of an expression that become one vertex with the same operands.
constexpr std::pair<Op, Act> kSameAct[] = {{Op::add, Act::add},
                                           {Op::subtract, Act::subtract},
                                           {Op::multiply, Act::multiply},
                                           {Op::divide, Act::divide},
                                           {Op::minimum, Act::minimum},
                                           {Op::maximum, Act::maximum},
                                           {Op::square_root, Act::square_root},
                                           {Op::exponential, Act::exponential},
                                           {Op::logarithm, Act::logarithm},
                                           {Op::sine, Act::sine},
                                           {Op::cosine, Act::cosine},
                                           {Op::clamp, Act::clamp}};
}  // namespace

int Reader::lower(const Tree& tree, const std::string& key) {
  const Node& n = *tree;
  if (n.op == Op::number) return graph_.constant(n.value);
  if (n.op == Op::name) return look_up(n, key);
  if (n.op == Op::select) {
    const Node& condition = *n.arguments[0];
    const int a = lower(condition.arguments[0], key), b = lower(condition.arguments[1], key);
    const int yes = lower(n.arguments[1], key), no = lower(n.arguments[2], key);
    return graph_.make(condition.op == Op::less ? Act::select_less : Act::select_less_equal, a, b, yes, no);
  }
  std::array<int, 3> v = {-1, -1, -1};
  for (std::size_t i = 0; i < n.arguments.size(); ++i) v[i] = lower(n.arguments[i], key);
  if (const auto* at = std::ranges::find(kSameAct, n.op, &std::pair<Op, Act>::first);
      at != std::end(kSameAct))
    return graph_.make(at->second, v[0], v[1], v[2]);
  if (n.op == Op::absolute)
    return graph_.make(Act::select_less, v[0], graph_.constant(0.0), graph_.negate(v[0]), v[0]);
  if (n.op == Op::dead_band) return graph_.dead_band(v[0], v[1]);
  if (n.op == Op::negate) return graph_.negate(v[0]);
  if (n.op == Op::power) return graph_.power(v[0], static_cast<int>(n.value));
  return graph_.constant(0.0);  // unreachable: the parser allows comparisons in select only
}

std::string Reader::names() const {
  std::string all;
  const auto add = [&](std::string_view name) { all += (all.empty() ? "" : ", ") + std::string(name); };
  for (const auto& [name, what] : taken_) add(name);
  for (const SignalRecord& s : kSignals) add(s.name);
  return all + ", pi, frequency; a signal's name with 0 is its value at the operating point";
}

int Reader::look_up(const Node& n, const std::string& key) {
  if (n.name == "pi") return graph_.constant(constants::pi);
  if (n.name == "frequency") return graph_.coefficient(kFrequency, true);
  if (const auto at = parameter_.find(n.name); at != parameter_.end())
    return graph_.coefficient(kFirstParameter + at->second, true);
  if (const auto at = state_.find(n.name); at != state_.end())
    return at->second == own_ ? graph_.state(at->second) : state_value(at->second);
  if (const auto at = named_.find(n.name); at != named_.end()) return named(n, key, at->second);
  if (const auto at = searched_.find(n.name); at != searched_.end()) return at->second;
  if (const int index = signal_index(n.name); index >= 0) return signal(n, key, index);
  if (n.name.size() > 1 && n.name.back() == '0') {
    const std::string base = n.name.substr(0, n.name.size() - 1);
    const int index = signal_index(base);
    if (index >= 0 && base != "t") return operating_value(n, key, index, base);
  }
  problem(key, n.at, "unknown name " + n.name, "no parameter, state, signal or block has this name",
          "use one of: " + names());
  return graph_.constant(0.0);
}

int Reader::signal(const Node& n, const std::string& key, int index) {
  const SignalRecord& s = kSignals[static_cast<std::size_t>(index)];
  if (s.made_in != Slot::machine && !(s.made_in < user_model_.slot)) {
    problem(key, n.at, "signal " + n.name,
            fmt::format("{} is computed before this signal is available", user_model_.output_name()),
            "read an earlier signal, or this signal's value at the operating point");
    return graph_.constant(0.0);
  }
  return graph_.signal(index);
}

int Reader::operating_value(const Node& n, const std::string& key, int index, const std::string& base) {
  const SignalRecord& s = kSignals[static_cast<std::size_t>(index)];
  const bool of_machine = s.made_in == Slot::machine || base == "Efd" || base == "Tm";
  if (!of_machine && !(s.made_in < user_model_.slot)) {
    problem(key, n.at, "signal " + n.name,
            fmt::format("{} is initialised before this value is known", user_model_.output_name()),
            "use the value of an earlier signal");
    return graph_.constant(0.0);
  }
  const auto [at, fresh] = operating_.try_emplace(n.name, -1);
  if (fresh) {
    at->second = graph_.coefficient(coefficients_, false);
    user_model_.operating.emplace_back(coefficients_++, index);
  }
  return at->second;
}

int Reader::named(const Node& n, const std::string& key, Named& entry) {
  if (entry.vertex >= 0) return entry.vertex;
  if (entry.open) {
    problem(key, n.at, "a loop through " + n.name, "its value would depend on itself",
            "break the loop with a state, e.g. a lag whose time constant has `low` above 0");
    return graph_.constant(0.0);
  }
  entry.open = true;
  const int own = std::exchange(own_, -1);
  const int vertex = entry.kind == Named::Kind::block ? block_output(n.name)
                                                      : lower(entry.expression.tree, entry.expression.key);
  own_ = own;
  entry.open = false;
  if (entry.kind == Named::Kind::reference && !graph_[vertex].fixed) {
    problem(entry.expression.key, 0, "reference " + n.name + " varies during the run",
            "a reference is computed once, before the run",
            "use parameters and values at the operating point (V0) only");
    return entry.vertex = graph_.constant(0.0);
  }
  return entry.vertex = vertex;
}

/// Returns the vertex of a state's value, clamped to its limits.
int Reader::state_value(int index) {
  const StateEntry& s = states_[static_cast<std::size_t>(index)];
  const int x = graph_.state(index);
  if (s.low < 0 && s.high < 0) return x;
  const double far = 1e300;
  return graph_.make(Act::limit, x, s.low < 0 ? graph_.constant(-far) : s.low,
                     s.high < 0 ? graph_.constant(far) : s.high);
}

}  // namespace swingbank::sim::user_models
