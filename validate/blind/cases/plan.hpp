#pragma once
// Which effects are hidden in which case of a run: drawn from the seed, so that a case's number tells
// nothing.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "validate/blind/cases/case.hpp"

namespace swingbank::validate::blind::cases {

struct BlindPlan {
  std::uint64_t seed = 0;
  std::vector<BlindSpec> cases;
};

/// `kinds`: names of the config, "A+B", "none", "listed", "odd", "pairs"; cases go round them evenly. Empty:
/// of every 25 cases 10 of listed kinds (in turn), 10 with nothing hidden, 3 odd, 2 pairs. Throws InputError
/// naming every unknown kind.
BlindPlan plan_blind(const BlindConfig& config, const std::vector<std::string>& kinds, int count,
                     std::uint64_t seed, double size);

/// Writes DIR/plan.json (seed, number of cases, hash of config and plan), or compares with the one that is
/// there: cases of two plans are never mixed. Throws InputError if they differ.
void settle_plan(const BlindPlan& plan, const BlindConfig& config, const std::filesystem::path& folder);

/// "c0001": numbers from 1.
std::string case_name(std::size_t index);
/// "K/N" with 1 <= K <= N.
std::pair<int, int> read_part(const std::string& text);

}  // namespace swingbank::validate::blind::cases
