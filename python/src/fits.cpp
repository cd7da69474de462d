// Python's Calibration, ParameterSelection and Addition: fits of a plant to records, without and with an
// added effect.
#include <fmt/format.h>

#include "base/json.hpp"
#include "python/src/fitted.hpp"
#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "validate/add/add.hpp"
#include "validate/add/report.hpp"
#include "validate/calibrate/report.hpp"
#include "validate/calibrate/wrong_parameters.hpp"
#include "validate/event/component_model.hpp"

namespace swingbank::python {
namespace {

using calibrate::Calibration, calibrate::WrongParameters, add::Addition;

/// Arguments of a fit, as given in Python.
struct FitArguments {
  std::vector<std::string> hold_out, fixed;
  double prior_sd = thresholds::parameters.prior_sd;
  bool power_only = false;
};

calibrate::CalibrateOptions options_of(const FitArguments& a, const std::shared_ptr<Callback>& callback) {
  calibrate::CalibrateOptions options;
  options.held_out = a.hold_out;
  options.fixed = a.fixed;
  options.prior_sd = a.prior_sd;
  options.events.measured_states = !a.power_only;
  options.progress = progress_of(callback);
  return options;
}

std::shared_ptr<Plant> plant_of(const Plant& model) {
  return std::make_shared<Plant>(event::whole_model(model));
}

std::vector<fit::FittedParameter> parameters_of(const Calibration& c) {
  std::vector<fit::FittedParameter> all;
  for (const auto& p : c.parameters) all.push_back(p.fit);
  return all;
}

bool is_adequate(const Calibration& c) { return c.adequacy != calibrate::Adequacy::structure_poor; }

py::array_t<double> correlation(const Calibration& c) {
  py::array_t<double> copy({c.correlation.rows(), c.correlation.cols()});
  auto to = copy.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < to.shape(0); ++i)
    for (py::ssize_t k = 0; k < to.shape(1); ++k) to(i, k) = c.correlation(i, k);
  return copy;
}

std::string html_of(const Calibration& c) {
  return "<div>" + verdict_html(c.sentence, is_adequate(c)) + table_html(calibrate::parameter_table(c)) +
         table_html(calibrate::event_table(c.events)) + "</div>";
}

std::vector<fit::FittedParameter> selected(const WrongParameters& w) {
  std::vector<fit::FittedParameter> all;
  for (const auto& p : w.found.wrong) all.push_back(p.fit);
  return all;
}

std::map<std::string, double> evidence_of(const WrongParameters& w) {
  std::map<std::string, double> all;
  for (const auto& p : w.found.wrong) all[p.fit.full_name()] = p.evidence;
  return all;
}

std::map<std::string, std::vector<std::string>> tied_of(const WrongParameters& w) {
  std::map<std::string, std::vector<std::string>> all;
  for (const auto& p : w.found.wrong) all[p.fit.full_name()] = p.tied;
  return all;
}

std::string html_of(const WrongParameters& w) {
  return "<div>" + verdict_html(w.sentence, w.is_adequate()) + parameters_html(selected(w)) + "</div>";
}

std::string html_of(const Addition& a) {
  return "<div>" + verdict_html(a.sentence, a.adequate && a.earns) + parameters_html(a.parameters) +
         table_html(add::addition_table(a)) + "</div>";
}

void bind_calibration(py::module_& module) {
  py::class_<Calibration, std::shared_ptr<Calibration>>(module, "Calibration",
                                                        "Parameters of a plant fitted to records.")
      .def_property_readonly(
          "plant", [](const Calibration& c) { return plant_of(c.model); }, "Plant with the fitted values.")
      .def_property_readonly("adequate", &is_adequate,
                             "Whether only noise remains; False: a component is missing, and the fitted\n"
                             "values are biased.")
      .def_readonly("sentence", &Calibration::sentence, "Verdict in words.")
      .def_property_readonly("parameters", &parameters_of, "Fitted parameters, a list of FittedParameter.")
      .def_property_readonly("correlation", &correlation,
                             "Correlation of the estimates, shape (parameters, parameters) [-].")
      .def_readonly("before", &Calibration::before, "Reduced chi-square before the fit [-].")
      .def_readonly("after", &Calibration::after, "Reduced chi-square after the fit [-].")
      .def_readonly("seconds", &Calibration::seconds, "Processing time [s].")
      .def(
          "to_dict",
          [](const Calibration& c) { return from_json(json_text(calibrate::calibration_json(c))); },
          "Returns the result of the fit, as in calibrate.json.")
      .def("_repr_html_", [](const Calibration& c) { return html_of(c); })
      .def("__str__", [](const Calibration& c) { return calibrate::terminal_report(c); })
      .def("__repr__", [](const Calibration& c) { return "<swingbank.Calibration: " + c.sentence + ">"; });
}

void bind_selection(py::module_& module) {
  py::class_<WrongParameters, std::shared_ptr<WrongParameters>>(
      module, "ParameterSelection", "Smallest set of parameters that must change to explain the records.")
      .def_property_readonly(
          "plant", [](const WrongParameters& w) { return plant_of(w.model); },
          "Plant with these parameters changed and all others unchanged.")
      .def_property_readonly("adequate", &WrongParameters::is_adequate,
                             "Whether only noise remains with these parameters changed.")
      .def_readonly("sentence", &WrongParameters::sentence, "Result in words.")
      .def_property_readonly("parameters", &selected,
                             "Selected parameters, a list of FittedParameter, the strongest evidence first.")
      .def_property_readonly("evidence", &evidence_of,
                             "Increase of chi-square if a parameter keeps its given value, by name [-].")
      .def_property_readonly(
          "tied", &tied_of,
          "Parameters that explain the records equally well in place of a selected one: {selected: [others]}.")
      .def_property_readonly(
          "before", [](const WrongParameters& w) { return w.found.before; },
          "Reduced chi-square of the given plant [-].")
      .def_property_readonly(
          "after", [](const WrongParameters& w) { return w.found.fit.reduced_chi2(); },
          "Reduced chi-square with these parameters changed [-].")
      .def(
          "to_dict", [](const WrongParameters& w) { return from_json(json_text(calibrate::wrong_json(w))); },
          "Returns the result of the selection, as in calibrate.json.")
      .def("_repr_html_", [](const WrongParameters& w) { return html_of(w); })
      .def("__str__", [](const WrongParameters& w) { return calibrate::wrong_text(w); })
      .def("__repr__",
           [](const WrongParameters& w) { return "<swingbank.ParameterSelection: " + w.sentence + ">"; });
}

void bind_addition(py::module_& module) {
  py::class_<Addition, std::shared_ptr<Addition>>(module, "Addition",
                                                  "An effect added to a plant and fitted.")
      .def_property_readonly(
          "plant", [](const Addition& a) { return plant_of(a.model); },
          "Plant with the effect and the fitted values.")
      .def_readonly("adequate", &Addition::adequate, "Whether only noise remains in every event.")
      .def_readonly(
          "accepted", &Addition::earns,
          "Whether the evidence of every added effect is very strong (above 10) and every held-out event improves\n"
          "or has only noise left.")
      .def_readonly("evidence", &Addition::evidence,
                    "2 ln(Bayes factor) over the refit without the effect [-].")
      .def_readonly("sentence", &Addition::sentence, "Result in words.")
      .def_readonly("parameters", &Addition::parameters,
                    "Fitted parameters, a list of FittedParameter, those of the effect first.")
      .def_readonly("own", &Addition::own, "Number of parameters of the effect.")
      .def_readonly("seconds", &Addition::seconds, "Processing time [s].")
      .def(
          "to_dict", [](const Addition& a) { return from_json(json_text(add::addition_json(a))); },
          "Returns the result of the addition, as in add.json.")
      .def("_repr_html_", [](const Addition& a) { return html_of(a); })
      .def("__str__", [](const Addition& a) { return add::terminal_report(a); })
      .def("__repr__", [](const Addition& a) { return "<swingbank.Addition: " + a.sentence + ">"; });
}

py::object calibrate_plant(const Plant& self, const py::object& records, const FitArguments& arguments,
                           bool sparse, const py::object& progress) {
  const auto samples = samples_of(records_of(self, records), false);
  const auto callback = std::make_shared<Callback>(progress);
  const auto fitted = [&](const auto& fit) {
    return py::cast(without_lock(
        [&] {
          auto result = fit(plant::as_submitted(self), samples, options_of(arguments, callback));
          return std::make_shared<decltype(result)>(std::move(result));
        },
        {callback}));
  };
  return sparse ? fitted(calibrate::wrong_parameters) : fitted(calibrate::calibrate);
}

/// Name of an effect, or names of several that are added together.
using Effects = std::variant<std::string, std::vector<std::string>>;

std::shared_ptr<Addition> add_to_plant(const Plant& self, const Effects& effects, const py::object& records,
                                       const FitArguments& arguments, const py::object& progress) {
  const auto samples = samples_of(records_of(self, records), false);
  const auto callback = std::make_shared<Callback>(progress);
  return without_lock(
      [&] {
        const Plant model = plant::as_submitted(self);
        add::AddOptions options;
        options.calibrate = options_of(arguments, callback);
        const auto* one = std::get_if<std::string>(&effects);
        const auto names = one ? std::vector{*one} : std::get<std::vector<std::string>>(effects);
        return std::make_shared<Addition>(add::add_effects(model, names, samples, options));
      },
      {callback});
}

}  // namespace

void bind_fits(py::module_& module, PlantClass& of) {
  bind_fitted(module);
  bind_calibration(module);
  bind_selection(module);
  bind_addition(module);
  constexpr double prior = thresholds::parameters.prior_sd;
  of.def(
        "calibrate",
        [](const Plant& self, const py::object& records, const std::vector<std::string>& hold_out,
           const std::vector<std::string>& fix, double prior_sd, bool power_only, bool sparse,
           const py::object& progress) {
          return calibrate_plant(self, records, {hold_out, fix, prior_sd, power_only}, sparse, progress);
        },
        py::arg("records"), py::kw_only(), py::arg("hold_out") = std::vector<std::string>{},
        py::arg("fix") = std::vector<std::string>{}, py::arg("prior_sd") = prior,
        py::arg("power_only") = false, py::arg("sparse") = false, py::arg("progress") = py::none(),
        "Fits the plant's parameters to records (or their paths), as `swingbank calibrate` does.\n\n"
        "`hold_out`: names of records excluded from the fit; `fix`: parameters that keep their values;\n"
        "`prior_sd`: prior standard deviation of the parameters, relative; `power_only`: the recorded\n"
        "speed, Efd and Ifd are not compared; `sparse`: selects the smallest set of parameters that must\n"
        "change, and returns a ParameterSelection in place of a Calibration; `progress`: called as\n"
        "progress(phase, item, done, total).\n"
        "Ctrl-C, or an exception of `progress`, ends the fit.")
      .def(
          "add",
          [](const Plant& self, const Effects& effect, const py::object& records,
             const std::vector<std::string>& hold_out, double prior_sd, bool power_only,
             const py::object& progress) {
            return add_to_plant(self, effect, records, {hold_out, {}, prior_sd, power_only}, progress);
          },
          py::arg("effect"), py::arg("records"), py::kw_only(),
          py::arg("hold_out") = std::vector<std::string>{}, py::arg("prior_sd") = prior,
          py::arg("power_only") = false, py::arg("progress") = py::none(),
          "Adds an effect (\"SEXS\", \"GENROU:S10,S12\"), or a list of effects that are fitted together, as\n"
          "`swingbank add` does.\n\n"
          "Arguments as for `calibrate`.");
}

}  // namespace swingbank::python
