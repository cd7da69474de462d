#pragma once
// Fitted parameters and report tables in Python and in notebooks.
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "validate/fit/fit.hpp"
#include "validate/report/document.hpp"

namespace swingbank::python {

/// Registers the Python class FittedParameter.
void bind_fitted(pybind11::module_& module);
/// Returns a table as HTML; texts are escaped.
std::string table_html(const validate::report::Table& table);
/// Returns the table of fitted parameters with their 95 % intervals as HTML.
std::string parameters_html(const std::vector<validate::fit::FittedParameter>& parameters);

}  // namespace swingbank::python
