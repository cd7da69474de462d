#pragma once
// Switching times that are known beforehand: given by the user (--switch), or that of a breaker.
#include <map>
#include <string>
#include <vector>

#include "validate/switching/switching.hpp"

namespace swingbank::validate::switching {

/// Returns the switching times [s] of each record, in ascending order. `words`: values of --switch, "2.0" for
/// the only record or "event.csv=2.0" for a named one; `files`: values of --records. Throws InputError with
/// every invalid word.
std::map<std::string, std::vector<double>> given_switching_times(const std::vector<std::string>& words,
                                                                 const std::vector<std::string>& files);

/// Returns the switching times that the user has given for a record; they are exact.
std::vector<Switching> given_times(const record::Record& record);

/// Returns the switching times of a record whose breaker opens. The time is that of the step found within
/// kNearBreaker of the given time, otherwise that at which P falls by half, otherwise the given time. Empty
/// if the breaker is open during the whole record.
std::vector<Switching> breaker_times(const record::Record& record, const std::vector<Switching>& found);
constexpr double kNearBreaker = 0.2;  ///< [s]

}  // namespace swingbank::validate::switching
