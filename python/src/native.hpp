#pragma once
// Shared parts of the extension `_native`: the C++ classes of the Python objects, and one function per source
// file that declares them.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <string>
#include <vector>

#include "validate/compare/fitness.hpp"
#include "validate/compare/played.hpp"
#include "validate/plant/plant_model.hpp"

namespace swingbank::python {

namespace py = pybind11;
using namespace swingbank::validate;

/// Python's Plant: an immutable plant model.
using Plant = plant::PlantModel;
/// Python's Record: an immutable record with its file and the warnings from reading and checking it.
struct Record {
  record::Record record;              ///< samples
  std::vector<std::string> warnings;  ///< repairs by the reader, and minor findings
  std::string source;                 ///< file as given; empty if created from arrays
};
/// Python's Playback: one event played into a plant.
struct Playback {
  std::shared_ptr<const Plant> plant;  ///< the plant that was played
  compare::EventComparison event;      ///< comparison of the measured and modelled channels
  bool complete = false;  ///< whether only noise remains in this event; in a Comparison: in all its events
};
/// Python's Comparison: several events played into a plant, with both verdicts.
struct Comparison {
  std::shared_ptr<const Plant> plant;             ///< the plant that was played
  std::vector<std::shared_ptr<Playback>> events;  ///< one for each record
  compare::Adequacy adequacy;                     ///< statistical verdict
  compare::Fitness fitness;                       ///< engineering verdict
};
/// Options of a playback, as in Python.
struct PlayOptions {
  bool power_only = false, fit_switchings = true;  ///< as the options of `swingbank compare`
  std::string input = "voltage";                   ///< "voltage" or "pq"
  double pre_event = 1.0;                          ///< length of the steady-state window [s]
};

/// Returns an array with a copy of the values times `scale`.
py::array_t<double> array(const std::vector<double>& values, double scale = 1.0);
/// Returns an array [rows][columns] of values in row order.
py::array_t<double> matrix(const std::vector<double>& values, std::size_t rows);
/// Returns the JSON as Python objects.
py::object from_json(const std::string& text);

/// Reads and checks records of the plant: Record objects, paths, or a list of both.
std::vector<Record> records_of(const Plant& plant, const py::object& records);
/// Returns the samples of the records; if `power_only`, without the measured states (speed, Efd, Ifd).
std::vector<record::Record> samples_of(const std::vector<Record>& records, bool power_only);

/// Plays one record.
std::shared_ptr<Playback> play(const std::shared_ptr<const Plant>& plant, const Record& record,
                               const PlayOptions& options);
/// Plays all records and judges the plant by the limits `accept`.
std::shared_ptr<Comparison> compare_all(const std::shared_ptr<const Plant>& plant,
                                        const std::vector<Record>& records, const PlayOptions& options,
                                        const std::string& accept);

/// Returns the notebook view of a record: plots of V, P and Q.
std::string html_of(const Record& record);
/// Returns the notebook view of a playback: a label with the RMS error and a plot for each channel.
std::string html_of(const Playback& playback);
/// Returns the notebook view of a comparison: both verdicts, and the view of each event.
std::string html_of(const Comparison& comparison);
/// Returns a verdict as one line of HTML. `good` determines the colour of the sentence.
std::string verdict_html(const std::string& sentence, bool good);

/// Python class of Plant; the other source files add their functions to it.
using PlantClass = py::class_<Plant, std::shared_ptr<Plant>>;
void bind_errors(py::module_& module);                            ///< InputError and KeyboardInterrupt
PlantClass bind_plant(py::module_& module);                       ///< Plant, Parameter
void bind_record(py::module_& module);                            ///< Record, Point
void bind_playback(py::module_& module, PlantClass& plant);       ///< Playback, Comparison, Channel
void bind_sensitivities(py::module_& module, PlantClass& plant);  ///< Sensitivities
void bind_fits(py::module_& module, PlantClass& plant);       ///< Calibration, ParameterSelection, Addition
void bind_diagnosis(py::module_& module, PlantClass& plant);  ///< Diagnosis
void bind_effects(py::module_& module);                       ///< Effect
void bind_simulation(py::module_& module);                    ///< Grid, Run

}  // namespace swingbank::python
