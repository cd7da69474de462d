#include "validate/compare/event_use.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace swingbank::validate::compare {

std::string EventUse::of(const std::string& record) const {
  if (!fitted) return "comparison";
  return std::ranges::count(held_out, record) > 0 ? "verification" : "fit";
}

std::string EventUse::sentence(const std::vector<std::string>& records) const {
  if (!fitted || records.empty()) return {};
  std::vector<std::string> verify;
  for (const auto& record : records)
    if (of(record) == "verification") verify.push_back(record);
  const std::size_t fits = records.size() - verify.size();
  const std::string fit = fmt::format("Fitted to {} event{}", fits, fits == 1 ? "" : "s");
  return verify.empty() ? fit + "; no independent event verifies the fit (--hold-out)."
                        : fmt::format("{}; verified by the independent event{} {}.", fit,
                                      verify.size() == 1 ? "" : "s", fmt::join(verify, ", "));
}

}  // namespace swingbank::validate::compare
