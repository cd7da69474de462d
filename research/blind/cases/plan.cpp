#include "research/blind/cases/plan.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "base/write_file.hpp"
#include "research/blind/cases/detail/random.hpp"

namespace swingbank::research::blind::cases {
namespace {

using Hidden = std::vector<const BlindKind*>;

std::vector<const BlindKind*> of(const BlindConfig& config, bool listed) {
  std::vector<const BlindKind*> list;
  for (const auto& kind : config.kinds)
    if (kind.listed == listed && kind.drawn) list.push_back(&kind);
  return list;
}

/// Assigns the kinds of each class (listed, unlisted) in turn, in a random order.
class Dealer {
 public:
  Dealer(const BlindConfig& config, BlindDraw& draw)
      : listed_(of(config, true)), unlisted_(of(config, false)) {
    shuffle(listed_, draw);
    shuffle(unlisted_, draw);
    for (const auto* a : listed_)
      for (const auto* b : listed_)
        if (a < b && a->side != b->side) pairs_.push_back({a, b});
    shuffle(pairs_, draw);
  }
  Hidden next(const std::string& word) {
    if (word == "none") return {};
    if (word == "listed") return {turn(listed_, n_listed_, word)};
    if (word == "odd") return {turn(unlisted_, n_unlisted_, word)};
    return turn(pairs_, n_pairs_, word);
  }
  template <class T>
  static void shuffle(std::vector<T>& list, BlindDraw& draw) {
    for (std::size_t k = list.size(); k > 1; --k) std::swap(list[k - 1], list[draw.below(k)]);
  }

 private:
  template <class T>
  static T turn(const std::vector<T>& list, std::size_t& count, const std::string& word) {
    if (list.empty())
      throw InputError({"no kind for '" + word + "'", "--kinds", "the config defines no kind of this class",
                        "add some, or choose other kinds"});
    return list[count++ % list.size()];
  }
  std::vector<const BlindKind*> listed_, unlisted_;
  std::vector<Hidden> pairs_;
  std::size_t n_listed_ = 0, n_unlisted_ = 0, n_pairs_ = 0;
};

bool is_class(const std::string& word) {
  return word == "none" || word == "listed" || word == "odd" || word == "pairs";
}

/// Returns the kinds that a word names: "A" or "A+B".
Hidden named(const BlindConfig& config, const std::string& word, Problems& problems) {
  Hidden hidden;
  std::istringstream parts(word);
  for (std::string name; std::getline(parts, name, '+');) {
    hidden.push_back(config.kind(name));
    if (hidden.back()) continue;
    std::string names;
    for (const auto& kind : config.kinds) names += (names.empty() ? "" : ", ") + kind.name;
    problems.add("no kind '" + name + "'", "--kinds " + word,
                 "the config has " + names + ", and the classes none, listed, odd, pairs",
                 "choose one or more of these");
  }
  return hidden;
}

std::string text_of(const BlindPlan& plan, const BlindConfig& config) {
  std::string list;
  for (const auto& one : plan.cases) {
    for (const auto* kind : one.hidden) list += kind->name + "+";
    list += fmt::format("{:g};", one.size);
  }
  return nlohmann::json{{"format", "swingbank-blind-plan-1"},
                        {"seed", plan.seed},
                        {"cases", plan.cases.size()},
                        {"config_hash", fmt::format("{:016x}", config.hash)},
                        {"plan_hash", fmt::format("{:016x}", XXH64(list.data(), list.size(), 0))}}
             .dump(1) +
         "\n";
}

}  // namespace

BlindPlan plan_blind(const BlindConfig& config, const std::vector<std::string>& kinds, int count,
                     std::uint64_t seed, double size) {
  BlindPlan plan{seed, {}};
  BlindDraw draw(seed, 0, 0xb11d);
  Dealer dealer(config, draw);
  Problems problems;
  std::vector<std::string> words = kinds;
  if (words.empty()) {  // for 500 cases: 200 listed, 200 nothing hidden, 60 unlisted, 40 pairs
    for (int k = 0; k < 10; ++k) words.insert(words.end(), {"listed", "none"});
    words.insert(words.end(), {"odd", "odd", "odd", "pairs", "pairs"});
  }
  std::vector<Hidden> all;
  for (int k = 0; k < count; ++k) {
    const std::string& word = words[static_cast<std::size_t>(k) % words.size()];
    all.push_back(is_class(word) ? dealer.next(word) : named(config, word, problems));
    if (!problems.empty() && k + 1 >= static_cast<int>(words.size())) break;
  }
  problems.raise();
  Dealer::shuffle(all, draw);
  for (std::size_t k = 0; k < all.size(); ++k) plan.cases.push_back({seed, k + 1, all[k], size});
  return plan;
}

void settle_plan(const BlindPlan& plan, const BlindConfig& config, const std::filesystem::path& folder) {
  const auto file = folder / "plan.json";
  const std::string text = text_of(plan, config);
  if (!std::filesystem::exists(file)) {
    try {
      write_file(file, text);
    } catch (const InputError&) {  // another part of the run may have written the file; see below
      if (!std::filesystem::exists(file)) throw;
    }
  }
  std::ostringstream there;
  there << std::ifstream(file, std::ios::binary).rdbuf();
  if (there.str() != text)
    throw InputError({"cases of another run", file.string(),
                      "its seed, number of cases, kinds or config differ",
                      "give another --out, or the options of that run"});
}

std::string case_name(std::size_t index) { return fmt::format("c{:04}", index + 1); }

std::pair<int, int> read_part(const std::string& text) {
  const auto slash = text.find('/');
  int part = 0, parts = 0;
  const auto read = [](std::string_view number, int& value) {
    const auto r = std::from_chars(number.data(), number.data() + number.size(), value);
    return r.ec == std::errc{} && r.ptr == number.data() + number.size();
  };
  const std::string_view view = text;
  if (slash == text.npos || !read(view.substr(0, slash), part) || !read(view.substr(slash + 1), parts) ||
      part < 1 || part > parts)
    throw InputError({"'" + text + "'", "--part", "a part is K/N with 1 <= K <= N", "write it like 2/4"});
  return {part, parts};
}

}  // namespace swingbank::research::blind::cases
