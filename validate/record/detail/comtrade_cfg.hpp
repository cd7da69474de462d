#pragma once
// The configuration of a COMTRADE record, and the way from it to the samples.
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "validate/record/comtrade.hpp"

namespace swingbank::validate::record {

struct ComtradeConfig {
  Comtrade about;  ///< all but samples
  int status = 0;  ///< number of status channels
  /// Rates [1/s] with the number of the last sample of each; empty: the stamps tell the times.
  std::vector<std::pair<double, long>> rates = {};
  long samples = 0;  ///< number of the last sample
  double stamp = 0;  ///< unit of the stamps [s], with the time multiplier
};

/// Adds a problem for every fault; what is returned is of use only if there is none.
ComtradeConfig parse_comtrade_config(std::string_view cfg, const std::string& name, Problems& problems);

/// Text between separators, without blanks around it.
std::vector<std::string_view> comtrade_fields(std::string_view line);
std::optional<double> comtrade_number(std::string_view text);
/// Cuts the first line off `text`; CR LF, LF and the end-of-file mark 0x1A end lines.
std::string_view comtrade_line(std::string_view& text);

}  // namespace swingbank::validate::record
