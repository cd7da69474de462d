#include "sim/formats/matpower.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/formats/detail/matpower_text.hpp"
#include "sim/formats/pslf_epc.hpp"
#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/consistency.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::formats {
namespace {

using matpower::Assignment;
using matpower::Row;

std::string text_of(long double value) {
  return std::isfinite(static_cast<double>(value)) ? psse::shortest(static_cast<double>(value)) : "infinite";
}

class CaseReader {
 public:
  CaseReader(const std::string& text, std::string name, double frequency)
      : file_(std::move(name)), fields_(matpower::read_assignments(text, file_, problems_)) {
    network_.origin = file_;
    network_.title = file_;
    network_.frequency = frequency;
  }

  network::Network read() {
    if (!(network_.frequency > 0) || !std::isfinite(network_.frequency))
      problems_.add(text_of(network_.frequency) + " Hz as the frequency", file_,
                    "it must be positive; the case itself contains none", "give 50 or 60 Hz");
    version();
    base();
    table("bus", 13, &CaseReader::bus);
    table("gen", 10, &CaseReader::generator);
    table("branch", 11, &CaseReader::branch);
    if (const Assignment* dc = find("dcline"))
      for (const Row& row : dc->rows)
        if (row.values.size() > 2 && row.values[2] > 0)
          problems_.add("a dc line in service", where(row), "dc lines are not modelled",
                        "replace it by equivalent loads");
    network::settle_isolated(network_);
    network::check_finite(network_, file_, problems_);
    problems_.raise();
    network::settle_generators(network_, [&](std::size_t i) { return generator_where_[i]; });
    network::settle_islands(network_);
    return std::move(network_);
  }

 private:
  [[nodiscard]] std::string where(const Row& row) const { return file_ + ":" + std::to_string(row.line); }
  [[nodiscard]] std::string where(const Assignment& a) const { return file_ + ":" + std::to_string(a.line); }

  const Assignment* find(const std::string& name) {
    const Assignment* found = nullptr;
    for (const Assignment& a : fields_) {
      if (a.name != name) continue;
      if (found)
        problems_.add(name + " is assigned twice", where(a),
                      "it is already on line " + std::to_string(found->line), "keep one of them");
      if (!found) found = &a;
    }
    return found;
  }
  const Assignment* require(const std::string& name) {
    const Assignment* found = find(name);
    if (!found)
      problems_.add("no " + name, file_, "a case needs version, baseMVA, bus, gen and branch",
                    "add mpc." + name + ", or restore the file if it is truncated");
    return found;
  }

  void version() {
    const Assignment* a = require("version");
    if (!a) return;
    const bool two = a->kind == Assignment::text
                         ? a->words == "2"
                         : a->rows.size() == 1 && a->rows[0].values == std::vector<long double>{2.0L};
    if (!two)
      problems_.add("the version of the case is not 2", where(*a), "only version 2 is read",
                    "load the case in MATPOWER and save it with savecase");
  }
  void base() {
    const Assignment* a = require("baseMVA");
    if (!a) return;
    const bool one = a->kind == Assignment::matrix && a->rows.size() == 1 && a->rows[0].values.size() == 1;
    const long double value = one ? a->rows[0].values[0] : 0.0L;
    if (!(value > 0) || !std::isfinite(static_cast<double>(value)) || !(static_cast<double>(value) > 0)) {
      problems_.add("baseMVA = " + (one ? text_of(value) : std::string("no number")), where(*a),
                    "all per-unit values refer to it", "give a base > 0 MVA");
      return;
    }
    network_.base_mva = static_cast<double>(value);
    base_ = network_.base_mva;
  }

  void table(const std::string& name, std::size_t columns, void (CaseReader::*row_of)(const Row&)) {
    const Assignment* a = require(name);
    if (!a) return;
    if (a->kind != Assignment::matrix || a->rows.empty()) {
      problems_.add("mpc." + name + " has no rows", where(*a), "the matrix has one row for each " + name,
                    "give at least one row");
      return;
    }
    const std::size_t wanted = std::max(columns, a->rows[0].values.size());
    for (const Row& row : a->rows) {
      if (row.values.size() == wanted) {
        (this->*row_of)(row);
        continue;
      }
      problems_.add("a row of " + name + " with " + std::to_string(row.values.size()) + " columns",
                    where(row),
                    wanted == columns ? std::to_string(columns) + " are required"
                                      : "the first row has " + std::to_string(wanted),
                    "give it " + std::to_string(wanted) + " columns");
    }
  }

  double finite(const Row& row, std::size_t column, const char* name) {
    const long double value = row.values[column];
    if (!std::isfinite(static_cast<double>(value)))
      problems_.add(std::string(name) + " = " + text_of(value), where(row), "it must be a finite number",
                    "give a finite number");
    return static_cast<double>(value);
  }
  double pu(const Row& row, std::size_t column, const char* name) {
    finite(row, column, name);
    return static_cast<double>(row.values[column] / base_);
  }
  int integer(const Row& row, std::size_t column, const char* name) {
    const long double value = row.values[column];
    if (value == std::floor(value) && std::abs(value) <= 999999999.0L) return static_cast<int>(value);
    problems_.add(std::string(name) + " = " + text_of(value), where(row),
                  "it is not a whole number of at most nine digits", "give such a number");
    return 0;
  }
  double radians(const Row& row, std::size_t column, const char* name) {
    finite(row, column, name);
    return static_cast<double>(row.values[column] / psse::kDegrees);
  }

  void bus(const Row& row) {
    network::Bus b{};
    b.number = integer(row, 0, "bus_i");
    const int type = integer(row, 1, "type");
    b.vm = finite(row, 7, "Vm");
    b.va = radians(row, 8, "Va");
    b.kv = finite(row, 9, "baseKV");
    b.area = integer(row, 6, "area");
    b.zone = integer(row, 10, "zone");
    b.type = static_cast<network::BusType>(type);
    if (b.number <= 0)
      problems_.add("bus number " + std::to_string(b.number), where(row), "numbers are positive",
                    "give a positive number");
    if (type < 1 || type > 4)
      problems_.add("type = " + std::to_string(type), where(row), "bus types are 1 to 4",
                    "give 1 (load), 2 (generator), 3 (reference) or 4 (isolated)");
    if (type != 4 && !(b.vm > 0))
      problems_.add("Vm = " + psse::shortest(b.vm) + " pu", where(row), "the power flow starts from it",
                    "give a voltage > 0 pu");
    const int index = static_cast<int>(network_.buses.size());
    if (!index_.emplace(b.number, index).second)
      problems_.add("bus " + std::to_string(b.number) + " appears twice", where(row), "each bus has one row",
                    "remove one or give it another number");
    network_.buses.push_back(b);
    const Complex load(pu(row, 2, "Pd"), pu(row, 3, "Qd")), shunt(pu(row, 4, "Gs"), pu(row, 5, "Bs"));
    if (load != Complex{}) network_.loads.push_back({index, "1", load, {}, {}, b.area, b.zone});
    if (shunt != Complex{}) network_.shunts.push_back({index, "1", shunt});
  }

  int find_bus(const Row& row, std::size_t column, const char* name) {
    const int number = integer(row, column, name);
    const auto found = index_.find(number);
    if (found != index_.end()) return found->second;
    problems_.add("bus " + std::to_string(number) + " is not in mpc.bus", where(row), "the row refers to it",
                  "add the bus or correct the number");
    return -1;
  }

  void generator(const Row& row) {
    network::Generator g{};
    g.bus = find_bus(row, 0, "bus");
    g.p = pu(row, 1, "Pg");
    g.q = pu(row, 2, "Qg");
    g.q_max = limit(row, 3, "Qmax");
    g.q_min = limit(row, 4, "Qmin");
    g.vset = finite(row, 5, "Vg");
    g.mva = finite(row, 6, "mBase");
    g.in_service = row.values[7] > 0;
    if (!(g.mva > 0))
      problems_.add("mBase = " + psse::shortest(g.mva) + " MVA", where(row),
                    "the machine's per-unit values refer to it", "give the machine's rating, > 0 MVA");
    if (g.in_service && !(g.vset > 0))
      problems_.add("Vg = " + psse::shortest(g.vset) + " pu", where(row),
                    "the generator regulates its bus to this voltage", "give a voltage > 0 pu");
    if (g.bus < 0) return;
    g.id = std::to_string(++generators_at_[g.bus]);
    generator_where_.push_back(where(row));
    network_.generators.push_back(std::move(g));
  }
  /// Returns a reactive limit [pu]; an infinite one becomes 1e4 pu, more than any machine can supply.
  double limit(const Row& row, std::size_t column, const char* name) {
    const long double value = row.values[column];
    if (std::isinf(value)) return std::copysign(1e4, static_cast<double>(value));
    return pu(row, column, name);
  }

  void branch(const Row& row) {
    network::Branch b{};
    b.from = find_bus(row, 0, "fbus");
    b.to = find_bus(row, 1, "tbus");
    b.r = finite(row, 2, "r");
    b.x = finite(row, 3, "x");
    b.b = finite(row, 4, "b");
    const double ratio = finite(row, 8, "ratio");
    b.tap = ratio == 0.0 ? 1.0 : ratio;
    b.shift = radians(row, 9, "angle");
    b.transformer = ratio != 0.0 || b.shift != 0.0;
    b.in_service = row.values[10] > 0;
    if (ratio < 0)
      problems_.add("ratio = " + psse::shortest(ratio), where(row), "a turns ratio must be positive",
                    "give a ratio > 0, or 0 for a line");
    if (b.from == b.to && b.from >= 0)
      problems_.add("a branch from bus " + text_of(row.values[0]) + " to itself", where(row),
                    "a branch connects two buses", "correct the bus numbers");
    if (b.from < 0 || b.to < 0) return;
    b.circuit = std::to_string(++branches_between_[std::minmax(b.from, b.to)]);
    network::raise_impedance(network_, b.r, b.x, network_.branch_text(b) + " (" + where(row) + ")");
    network_.branches.push_back(std::move(b));
  }

  std::string file_;
  Problems problems_;
  std::vector<Assignment> fields_;
  network::Network network_;
  long double base_ = 100.0L;
  std::map<int, int> index_, generators_at_;
  std::map<std::pair<int, int>, int> branches_between_;
  std::vector<std::string> generator_where_;
};

}  // namespace

network::Network parse_matpower(const std::string& text, const std::string& name, double frequency_hz) {
  return CaseReader(text, name, frequency_hz).read();
}
network::Network read_matpower(const std::filesystem::path& file, double frequency_hz) {
  std::string text;
  for (const std::string& line : psse::read_lines(file)) text += line + "\n";
  return parse_matpower(text, file.string(), frequency_hz);
}

network::Network read_network(const std::filesystem::path& file, const RawOptions& options) {
  if (is_epc(file)) return read_epc(file, options);
  if (file.extension() == ".m") {
    if (!options.frequency_hz && options.needs_frequency)
      throw InputError({"no frequency", file.string(), "a MATPOWER case contains no frequency",
                        "give --frequency-hz (in a config: frequency_hz), 50 or 60 Hz"});
    return read_matpower(file, options.frequency_hz.value_or(1.0));
  }
  network::Network network = read_raw(file, options);
  if (options.frequency_hz && *options.frequency_hz != network.frequency)
    throw InputError({"a frequency of " + text_of(*options.frequency_hz) + " Hz", file.string(),
                      "the file has BASFRQ = " + psse::shortest(network.frequency) + " Hz",
                      "drop --frequency-hz (in a config: frequency_hz) or correct the file"});
  return network;
}

RawSurvey survey_network(const std::filesystem::path& file, const RawOptions& options) {
  if (is_epc(file)) return survey_epc(file, options);
  if (file.extension() != ".m") return survey_raw(file, options);
  RawSurvey survey;
  survey.network = read_network(file, options);
  return survey;
}

}  // namespace swingbank::sim::formats
