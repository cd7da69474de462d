#pragma once
// Bars and scatter plots as inline SVG; the page's style sheet colours them.
#include <string>

#include "validate/report/document.hpp"

namespace swingbank::validate::report {

/// Returns the name of a curve's role in style sheets and scripts.
const char* ink_name(Ink ink);
/// Returns the bar chart.
std::string bars_svg(const Bars& bars);
/// Returns the scatter plot.
std::string scatter_svg(const Scatter& scatter);
/// Returns title and legend of a scatter plot as HTML.
std::string scatter_legend(const Scatter& scatter);

}  // namespace swingbank::validate::report
