#pragma once
// Plan of a blind run: the hidden effects of each case, drawn at random from the seed.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "research/blind/cases/case.hpp"

namespace swingbank::research::blind::cases {

struct BlindPlan {
  std::uint64_t seed = 0;
  std::vector<BlindSpec> cases;
};

/// Plans `count` cases. The entries of `kinds` are used in turn: names of the config, "A+B", "none",
/// "listed", "odd" (unlisted) or "pairs". If `kinds` is empty, of every 25 cases 10 have a listed kind, 10 no
/// hidden effect, 3 an unlisted disturbance and 2 a pair. Throws InputError with every unknown kind.
BlindPlan plan_blind(const BlindConfig& config, const std::vector<std::string>& kinds, int count,
                     std::uint64_t seed, double size);

/// Writes plan.json (seed, number of cases, hashes of config and plan) to `folder`. If the file exists,
/// compares it, so that cases of two plans are never mixed. Throws InputError if it differs.
void settle_plan(const BlindPlan& plan, const BlindConfig& config, const std::filesystem::path& folder);

/// Returns the name of a case, "c0001" for index 0.
std::string case_name(std::size_t index);
/// Reads "K/N" with 1 <= K <= N. Throws InputError otherwise.
std::pair<int, int> read_part(const std::string& text);

}  // namespace swingbank::research::blind::cases
