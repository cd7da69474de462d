// Python's Record and Point: files and arrays as checked records of a plant.
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <set>

#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"
#include "validate/check/record_set.hpp"
#include "validate/event/point.hpp"

namespace swingbank::python {
namespace {

using Columns = std::map<std::string, std::vector<double>>;

/// Names of the columns to read, by quantity.
using ColumnNames = std::map<std::string, std::string>;

/// Python's Point: a measuring point of several units, and the plant of the unit under test.
struct Point {
  event::MeasuredPoint point;
  std::shared_ptr<Plant> plant;
};

/// Reads and checks all files together, so that their problems are reported at once.
std::vector<Record> read_files(const Plant& plant, const std::vector<std::string>& files,
                               const check::Preparing& prepare = {}) {
  check::RecordSet set = without_lock([&] {
    Problems problems;
    check::RecordSet all = check::read_records(files, plant, problems, prepare);
    problems.raise();
    return all;
  });
  std::vector<Record> all;
  for (std::size_t k = 0; k < files.size(); ++k)
    all.push_back({std::move(set.records[k]), std::move(set.warnings[k]), files[k]});
  return all;
}

/// Returns a copy of the plant whose records are read from the named columns.
Plant with_columns(const Plant& plant, const ColumnNames& columns) {
  Plant changed = plant;
  for (const auto& [quantity, column] : columns) changed.reading.columns[quantity] = column;
  return changed;
}

std::shared_ptr<Point> point_of(const std::filesystem::path& file, const Plant& plant) {
  return std::make_shared<Point>(without_lock([&] {
    auto changed = std::make_shared<Plant>(plant);
    event::MeasuredPoint point = event::load_point(file, *changed);
    return Point{std::move(point), changed};
  }));
}

std::vector<std::string> names_of(const std::vector<event::OtherUnit>& units) {
  std::vector<std::string> names;
  for (const auto& unit : units) names.push_back(unit.model.name);
  return names;
}

std::vector<Record> records_at(const Point& point, const std::vector<std::filesystem::path>& files,
                               const ColumnNames& columns) {
  return read_files(with_columns(*point.plant, columns), {files.begin(), files.end()},
                    [&](record::Record r) { return event::of_tried_unit(point.point, std::move(r)); });
}

/// Returns the columns as the text of a CSV file, exact to the last bit.
std::string csv_text(const Columns& columns, const std::string& name) {
  std::string text;
  std::size_t rows = 0;
  for (const auto& [heading, values] : columns) {
    text += (text.empty() ? "" : ",") + heading;
    rows = std::max(rows, values.size());
  }
  for (const auto& [heading, values] : columns)
    if (values.size() != rows)
      throw InputError({fmt::format("column {} with {} of {} samples", heading, values.size(), rows), name,
                        "all columns have the same length", "give one value for each sample"});
  for (std::size_t row = 0; row < rows; ++row) {
    text += '\n';
    for (auto column = columns.begin(); column != columns.end(); ++column)
      fmt::format_to(std::back_inserter(text), "{}{:.17g}", column == columns.begin() ? "" : ",",
                     column->second[row]);
  }
  return text + '\n';
}

Record from_columns(const Plant& plant, const Columns& columns, const std::string& name) {
  return without_lock([&] {
    record::Record made =
        record::parse_record(csv_text(columns, name), name, plant.record_base, plant.reading);
    auto warnings = check::warnings_of(check::check_record(made, check::plant_facts(plant)));
    warnings.insert(warnings.begin(), made.notes.begin(), made.notes.end());
    return Record{std::move(made), std::move(warnings), ""};
  });
}

/// Optional channels by name; P and Q are in MW and Mvar.
struct RecordedChannel {
  const char *name, *unit;
  std::vector<double> record::Record::*values;
  bool power;
};
constexpr RecordedChannel kRecorded[] = {
    {"V", "pu", &record::Record::V, false},      {"theta", "rad", &record::Record::theta, false},
    {"P", "MW", &record::Record::P, true},       {"Q", "Mvar", &record::Record::Q, true},
    {"f", "pu", &record::Record::f, false},      {"speed", "pu", &record::Record::speed, false},
    {"Efd", "pu", &record::Record::Efd, false},  {"Ifd", "pu", &record::Record::Ifd, false},
    {"Vs", "pu", &record::Record::Vs, false},    {"Vref", "pu", &record::Record::Vref, false},
    {"Pm", "MW", &record::Record::Pm, true},     {"Pref", "MW", &record::Record::Pref, true},
    {"gate", "pu", &record::Record::gate, false}};

std::map<std::string, std::string> units_of(const Record& r) {
  std::map<std::string, std::string> units;
  for (const RecordedChannel& c : kRecorded)
    if (!(r.record.*c.values).empty()) units[c.name] = c.unit;
  return units;
}

py::array_t<double> channel_of(const Record& r, const std::string& name) {
  for (const RecordedChannel& c : kRecorded)
    if (name == c.name && !(r.record.*c.values).empty())
      return array(r.record.*c.values, c.power ? r.record.base.mva : 1.0);
  throw py::key_error(name);
}

}  // namespace

std::vector<Record> records_of(const Plant& plant, const py::object& given) {
  if (py::isinstance<Record>(given)) return {given.cast<Record>()};
  const py::object text_of = py::module_::import("os").attr("fspath");
  const bool one = py::isinstance<py::str>(given) || py::hasattr(given, "__fspath__");
  std::vector<Record> all;
  std::vector<std::string> files;
  std::vector<std::size_t> places;
  for (const py::handle item : one ? py::make_tuple(given) : py::tuple(given)) {
    if (py::isinstance<Record>(item)) {
      all.push_back(item.cast<Record>());
      continue;
    }
    places.push_back(all.size());
    files.push_back(text_of(item).cast<std::string>());
    all.emplace_back();
  }
  if (files.empty()) return all;
  std::vector<Record> read = read_files(plant, files);
  for (std::size_t k = 0; k < files.size(); ++k) all[places[k]] = std::move(read[k]);
  return all;
}

std::vector<record::Record> samples_of(const std::vector<Record>& records, bool power_only) {
  std::vector<record::Record> all;
  std::set<std::string> names;
  for (const Record& r : records) {
    all.push_back(r.record);
    if (!names.insert(r.record.name).second)
      throw InputError({"two records named " + r.record.name, "records", "results are listed by name",
                        "give every record a unique name"});
  }
  if (all.empty())
    throw InputError({"no records", "records", "nothing can be compared", "give at least one record"});
  return power_only ? compare::power_only(std::move(all)) : all;
}

namespace {

void bind_point(py::module_& module) {
  py::class_<Point, std::shared_ptr<Point>>(
      module, "Point", "Measuring point behind which several units or a collector are connected.")
      .def(py::init(&point_of), py::arg("file"), py::arg("plant"),
           "Reads a point file (.toml) for the tested unit `plant`, as `--point` of the commands.\n\n"
           "Raises InputError with every fault of the file.")
      .def_readonly(
          "plant", &Point::plant,
          "Plant of the tested unit. A control that measures at a remote bus measures at this point.")
      .def_property_readonly(
          "others", [](const Point& p) { return names_of(p.point.others); }, "Names of the other units.")
      .def("records", &records_at, py::arg("files"), py::kw_only(), py::arg("columns") = ColumnNames{},
           "Reads records of the point and returns those of the tested unit, a list of Record: at the\n"
           "units' bus, less the simulated P [MW] and Q [Mvar] of the other units.\n\n"
           "`columns`: as for Record. Raises InputError with the faults of all files.")
      .def("__repr__", [](const Point& p) {
        return fmt::format("<swingbank.Point {}: {} and {} other units>", p.point.file, p.plant->name,
                           p.point.others.size());
      });
}

}  // namespace

void bind_record(py::module_& module) {
  py::class_<Record, std::shared_ptr<Record>>(
      module, "Record", "Measurements at one plant's terminal: uniformly sampled, checked, immutable.")
      .def(
          py::init([](const std::filesystem::path& file, const Plant& plant, const ColumnNames& columns) {
            return std::make_shared<Record>(
                std::move(read_files(with_columns(plant, columns), {file.string()}).front()));
          }),
          py::arg("file"), py::arg("plant"), py::kw_only(), py::arg("columns") = ColumnNames{},
          "Reads a record (CSV, COMTRADE, PSS/E .plb, MATLAB, HDF5), whose bases are the plant's.\n\n"
          "`columns`: names of the columns by quantity, {\"V\": \"BUS1.VPM [kV]\", \"P\": \"-PLOC\", \"t\": \"#1\"},\n"
          "as `--columns` of the commands: the unit where the file names none, - for the opposite sign,\n"
          "#2 for the second column. Columns of other quantities are recognised by their headings.\n"
          "Raises InputError with every fault of the file and its lines.")
      .def_static(
          "from_columns",
          [](const Columns& columns, const Plant& plant, const std::string& name) {
            return std::make_shared<Record>(from_columns(plant, columns, name));
          },
          py::arg("columns"), py::arg("plant"), py::arg("name") = "record.csv",
          "Creates a record from arrays of shape (samples,), named as the columns of a CSV file:\n"
          "{\"t_s\": t, \"V_kV\": V, \"theta_deg\": a, \"P_MW\": P, \"Q_Mvar\": Q}.\n\n"
          "Raises InputError with every fault, as for a file.")
      .def_property_readonly(
          "name", [](const Record& r) { return r.record.name; }, "File name without folder.")
      .def_readonly("source", &Record::source, "File name as given; empty if created from arrays.")
      .def_property_readonly(
          "t", [](const Record& r) { return array(r.record.t); }, "Times, shape (samples,) [s].")
      .def_property_readonly("units", &units_of, "Recorded channels with their units: {\"P\": \"MW\"}.")
      .def_readonly("warnings", &Record::warnings, "Repairs on reading, and findings of the checks.")
      .def("__getitem__", &channel_of, py::arg("channel"),
           "Returns the samples of a channel, shape (samples,), in its unit of `units`.")
      .def("_repr_html_", [](const Record& r) { return html_of(r); })
      .def("__len__", [](const Record& r) { return r.record.samples(); })
      .def("__repr__", [](const Record& r) {
        return fmt::format("<swingbank.Record {}: {} samples at {:.4g}/s>", r.record.name, r.record.samples(),
                           r.record.rate());
      });
  bind_point(module);
}

}  // namespace swingbank::python
