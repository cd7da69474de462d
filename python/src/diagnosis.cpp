// Python's Diagnosis: missing effect of a plant model, with every hypothesis and the inferred inputs.
#include <fmt/format.h>

#include "base/json.hpp"
#include "python/src/fitted.hpp"
#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "validate/diagnose/report.hpp"
#include "validate/diagnose/text.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::python {
namespace {

/// Python's Diagnosis: the diagnosed model and the result.
struct Diagnosis {
  Plant model;
  diagnose::Diagnosis result;
};

report::Provenance provenance(const Diagnosis& d) {
  return diagnose::diagnosis_provenance(d.model, d.result, "swingbank.Plant.diagnose");
}

py::dict as_dict(const hypothesis::Judgement& j) {
  py::dict row;
  row["name"] = hypothesis::full_name(j.hypothesis);
  row["description"] = j.hypothesis.what;
  row["side"] = std::string(hypothesis::side_name(j.hypothesis.side));
  row["evidence"] = j.gain;
  row["reduced_chi2"] = j.fit.values > 0 ? j.fit.reduced_chi2() : 0.0;
  row["accepted"] = j.accepted;
  row["why_not"] = j.why_not;
  return row;
}

py::list hypotheses(const Diagnosis& d) {
  py::list all;
  for (const auto& j : d.result.ranked) all.append(as_dict(j));
  return all;
}

py::dict probabilities(const Diagnosis& d) {
  py::dict all;
  for (const auto& e : d.result.probabilities) all[py::str(e.name)] = e.probability;
  return all;
}

/// Returns an inferred input as {"record": (times, values)}.
py::dict inferred(const Diagnosis& d, const reduced::FreeInput& input) {
  py::dict all;
  for (std::size_t k = 0; k < input.fit.events.size() && k < d.result.events.size(); ++k) {
    const playin::PiecewiseLinear& of = input.of(k);
    all[py::str(d.result.events[k].record.name)] = py::make_tuple(array(of.t), array(of.value));
  }
  return all;
}

std::string html_of(const Diagnosis& d) {
  report::Table table{"", {"explanation", "probability", "evidence"}, {}};
  for (const auto& e : d.result.probabilities)
    table.rows.push_back(
        {e.name, report::probability_text(e.probability), fmt::format("{:.1f}", e.evidence)});
  return "<div>" + verdict_html(d.result.sentence, d.result.verdict == diagnose::Verdict::adequate) +
         table_html(table) + "</div>";
}

void bind_class(py::module_& module) {
  py::class_<Diagnosis, std::shared_ptr<Diagnosis>>(module, "Diagnosis", "Missing effect of a plant model.")
      .def_property_readonly(
          "verdict", [](const Diagnosis& d) { return std::string(verdict_name(d.result.verdict)); },
          "\"adequate\", \"missing\", \"confusable\" or \"unexplained\".")
      .def_property_readonly(
          "side", [](const Diagnosis& d) { return std::string(side_name(d.result.side)); },
          "Subsystem of the missing effect: \"excitation\", \"mechanical\", \"machine\", \"measurement\" or \"none\".")
      .def_property_readonly(
          "sentence", [](const Diagnosis& d) { return d.result.sentence; }, "Verdict in words.")
      .def_property_readonly(
          "effects", [](const Diagnosis& d) { return d.result.effects; }, "Names of the missing effects.")
      .def_property_readonly("probabilities", &probabilities,
                             "Probability of each explanation by name, most probable first.")
      .def_property_readonly(
          "hypotheses", &hypotheses,
          "Every hypothesis: name, description, side, evidence, reduced_chi2, accepted,\n"
          "why_not; accepted ones first, each group in descending order of evidence. An unpromising\n"
          "one was not fitted and has the reduced_chi2 of the given plant.")
      .def_property_readonly(
          "torque", [](const Diagnosis& d) { return inferred(d, d.result.torque); },
          "Inferred additional torque [pu on the machine base] for each record: (times [s], values), arrays of\n"
          "equal length, linearly interpolated.")
      .def_property_readonly(
          "field", [](const Diagnosis& d) { return inferred(d, d.result.field); },
          "Inferred additional field voltage [pu of the air-gap line] for each record: (times [s], values), arrays\n"
          "of equal length, linearly interpolated.")
      .def_property_readonly(
          "seconds", [](const Diagnosis& d) { return d.result.seconds; }, "Elapsed time [s].")
      .def(
          "to_dict",
          [](const Diagnosis& d) {
            return from_json(json_text(diagnose::diagnosis_json(d.model, d.result, provenance(d))));
          },
          "Returns the content of diagnosis.json.")
      .def(
          "to_html",
          [](const Diagnosis& d) { return diagnose::diagnosis_html(d.model, d.result, provenance(d)); },
          "Returns report.html, a self-contained page.")
      .def("_repr_html_", [](const Diagnosis& d) { return html_of(d); })
      .def("__str__", [](const Diagnosis& d) { return diagnose::diagnosis_text(d.result); })
      .def("__repr__", [](const Diagnosis& d) { return "<swingbank.Diagnosis: " + d.result.sentence + ">"; });
}

std::shared_ptr<Diagnosis> diagnose_plant(const Plant& self, const py::object& records, double prior_sd,
                                          bool power_only, int threads, const py::object& progress,
                                          const py::object& preliminary) {
  const auto samples = samples_of(records_of(self, records), false);
  const auto callback = std::make_shared<Callback>(progress);
  const auto said = std::make_shared<Callback>(preliminary);
  return without_lock(
      [&] {
        diagnose::DiagnoseOptions options;
        options.prior_sd = prior_sd;
        options.threads = threads;
        options.events.measured_states = !power_only;
        options.progress = progress_of(callback);
        if (said->given())
          options.preliminary_result = [said](const std::string& sentence, const diagnose::Diagnosis&) {
            (*said)(sentence);
          };
        Plant model = plant::as_submitted(self);
        diagnose::Diagnosis result = diagnose::diagnose(model, samples, options);
        return std::make_shared<Diagnosis>(Diagnosis{std::move(model), std::move(result)});
      },
      {callback, said});
}

}  // namespace

void bind_diagnosis(py::module_& module, PlantClass& of) {
  bind_class(module);
  constexpr double prior = thresholds::parameters.prior_sd;
  of.def(
      "diagnose", &diagnose_plant, py::arg("records"), py::kw_only(), py::arg("prior_sd") = prior,
      py::arg("power_only") = false, py::arg("threads") = 0, py::arg("progress") = py::none(),
      py::arg("preliminary") = py::none(),
      "Identifies the effect missing from the plant model, from two or more records, as `swingbank diagnose`\n"
      "does.\n\n"
      "`progress`: called as progress(phase, item, done, total); `preliminary`: called with each\n"
      "preliminary result in words; `threads`: 0 for one per core; other parameters as in `calibrate`.\n"
      "Ctrl-C, or an exception of a callback, ends the diagnosis.");
}

}  // namespace swingbank::python
