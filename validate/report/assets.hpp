#pragma once
// Scripts and style sheets of the reports and of the live page, as part of the binary.
#include <string_view>

namespace swingbank::validate::report {

/// File that is part of the binary.
struct Asset {
  std::string_view name;  ///< file name
  std::string_view text;  ///< content; empty: no such file
};
/// Returns the file of that name, from validate/report/assets or validate/report/uplot.
Asset asset(std::string_view name);

}  // namespace swingbank::validate::report
