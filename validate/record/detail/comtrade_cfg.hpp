#pragma once
// Configuration file of a COMTRADE record.
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "validate/record/comtrade.hpp"

namespace swingbank::validate::record {

struct ComtradeConfig {
  Comtrade about;  ///< without samples
  int status = 0;  ///< number of status channels
  /// Rates [1/s] with the number of the last sample of each; empty: time stamps determine the times.
  std::vector<std::pair<double, long>> rates = {};
  long samples = 0;  ///< number of the last sample
  double stamp = 0;  ///< unit of the stamps [s], including the time multiplier
};

/// Parses the configuration and adds a problem for every fault; the result is valid only if there is none.
ComtradeConfig parse_comtrade_config(std::string_view cfg, const std::string& name, Problems& problems);

/// Returns the text between commas, without surrounding blanks, CR and the end-of-file mark 0x1A.
std::vector<std::string_view> comtrade_fields(std::string_view line);
std::optional<double> comtrade_number(std::string_view text);

}  // namespace swingbank::validate::record
