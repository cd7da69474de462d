#include "python/src/fitted.hpp"

#include <fmt/format.h>

#include "python/src/native.hpp"

namespace swingbank::python {

void bind_fitted(py::module_& module) {
  using fit::FittedParameter;
  py::class_<FittedParameter>(module, "FittedParameter", "A fitted parameter with its 95 % interval.")
      .def_property_readonly("name", &FittedParameter::full_name, "\"GENROU.H\"")
      .def_readonly("unit", &FittedParameter::unit)
      .def_readonly("start", &FittedParameter::start, "Value before the fit [unit].")
      .def_readonly("value", &FittedParameter::value, "Fitted value [unit].")
      .def_readonly("error", &FittedParameter::error, "Standard error [unit]; NaN if the fit is singular.")
      .def_readonly("low", &FittedParameter::low, "Lower end of the 95 % interval [unit].")
      .def_readonly("high", &FittedParameter::high, "Upper end of the 95 % interval [unit].")
      .def_readonly(
          "decided", &FittedParameter::decided,
          "Reduction of the parameter's variance by the records, 1 - posterior variance / prior variance.")
      .def_readonly("at_bound", &FittedParameter::at_bound,
                    "Whether the value is at its bound, where the interval is not valid.")
      .def("__repr__", [](const FittedParameter& p) {
        return fmt::format("<swingbank.FittedParameter {} = {:.4g} ± {:.2g} {}>", p.full_name(), p.value,
                           p.error, p.unit);
      });
}

std::string table_html(const report::Table& table) {
  std::string text = "<table>";
  if (!table.caption.empty()) text += "<caption>" + report::escape(table.caption) + "</caption>";
  text += "<tr>";
  for (const auto& heading : table.header) text += "<th>" + report::escape(heading) + "</th>";
  text += "</tr>";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (const auto& cell : row) text += "<td>" + report::escape(cell.text) + "</td>";
    text += "</tr>";
  }
  return text + "</table>";
}

std::string parameters_html(const std::vector<fit::FittedParameter>& parameters) {
  report::Table table{"", {"parameter", "before", "after", "95 % interval"}, {}};
  for (const auto& p : parameters)
    table.rows.push_back(
        {fmt::format("{} [{}]", p.full_name(), p.unit), fmt::format("{:.4g}", p.start),
         fmt::format("{:.4g}", p.value),
         p.at_bound ? std::string("at its bound") : fmt::format("{:.4g} to {:.4g}", p.low, p.high)});
  return table_html(table);
}

}  // namespace swingbank::python
