#include "validate/thresholds/adequacy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace swingbank::validate::thresholds {

const CriterionRecord& criterion_record(Criterion criterion) {
  static constexpr std::array<CriterionRecord, 7> records = {{
      {"bins",
       "bins of the error maps that exceed their noise limit, or whose noise limit exceeds the "
       "channel's nominal value",
       "bins"},
      {"events", "largest reduced chi-square of an event, parameters refitted", "chi2 per value"},
      {"reduced_chi2", "reduced chi-square of all events, parameters refitted", "chi2 per value"},
      {"slow", "slow drift of the residual, parameters refitted", "standard deviations"},
      {"line", "chi2 of a steady oscillation of one frequency in all events, above its penalty", "chi2"},
      {"free_input", "evidence of an inferred input", "chi2"},
      {"named_effect", "evidence of the named effect", "chi2"},
  }};
  return records[static_cast<std::size_t>(criterion)];
}

Ruling judged_by_bins(int exceeding, int bins) {
  return {Criterion::bins, exceeding == 0, static_cast<double>(exceeding), 0, fmt::format("of {}", bins)};
}

double event_limit(double standard_deviation, double least) {
  return std::max(least, 1 + adequacy.one_in_thousand * standard_deviation);
}

Ruling judged_by_remainder(const Refitted& r, double least) {
  const Ruling reduced_chi2{Criterion::reduced_chi2, r.reduced_chi2 <= least, r.reduced_chi2, least},
      slow{Criterion::slow, r.slow < adequacy.slow, r.slow, adequacy.slow},
      line{Criterion::line, r.line <= adequacy.line, r.line, adequacy.line},
      torque{Criterion::free_input, r.torque <= evidence.accepted, r.torque, evidence.accepted, "torque"},
      field{Criterion::free_input, r.field <= evidence.accepted, r.field, evidence.accepted, "field voltage"};
  for (const Ruling& one : {reduced_chi2, slow, line, torque, field})
    if (!one.adequate) return one;
  return reduced_chi2;
}

Ruling judged_by_evidence(const std::string& effect, double strength) {
  return {Criterion::named_effect, false, strength, evidence.accepted, effect};
}

}  // namespace swingbank::validate::thresholds
