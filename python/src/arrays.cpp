// Conversion of samples and JSON to Python objects.
#include <algorithm>

#include "python/src/native.hpp"

namespace swingbank::python {

py::array_t<double> array(const std::vector<double>& values, double scale) {
  py::array_t<double> copy(static_cast<py::ssize_t>(values.size()));
  std::ranges::transform(values, copy.mutable_data(), [scale](double v) { return v * scale; });
  return copy;
}

py::array_t<double> matrix(const std::vector<double>& values, std::size_t rows) {
  const auto columns = rows == 0 ? 0 : values.size() / rows;
  py::array_t<double> copy({rows, columns});
  std::ranges::copy(values, copy.mutable_data());
  return copy;
}

py::object from_json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

}  // namespace swingbank::python
