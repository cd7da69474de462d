// Reader of .raw equipment without a model: dc lines, FACTS and GNE devices, induction machines. It reads
// their buses and scheduled dc powers; their ac power follows from the file's solved voltages.
#include <algorithm>
#include <cmath>

#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats::psse {

std::vector<Record> RawReader::following(const Record& first, std::size_t count, const char* what) {
  std::vector<Record> rows;
  while (rows.size() < count) {
    auto record = next();
    if (!record) break;  // the section reports the truncation
    if (record->fields.size() == 1 && (ends_section(*record) || ends_file(*record))) {
      put_back(*record);
      problems_.add(std::string(what) + " with " + std::to_string(rows.size() + 1) + " lines",
                    Fields(first, file_, problems_).where(),
                    std::to_string(count + 1) + " lines are required", "complete the record");
      break;
    }
    rows.push_back(std::move(*record));
  }
  return rows;
}

void RawReader::device(const std::string& kind, const std::string& name, const Record& record,
                       const std::vector<int>& numbers, const std::vector<double>& scheduled) {
  if (units_only_) return;
  const Fields f(record, file_, problems_);
  network::Device d{kind + " '" + name + "'", f.where(), {}, scheduled};
  for (const int number : numbers)
    if (number != 0) d.buses.push_back(find_bus(std::abs(number), f));
  devices_.push_back(std::move(d));
}

void RawReader::two_terminal_dc(const Record& first) {
  Fields f(first, file_, problems_);
  const auto rows = following(first, 2, "a two-terminal dc line");
  if (rows.size() < 2 || f.integer(1, "MDC", 0) == 0) return;  // blocked
  Fields rectifier(rows[0], file_, problems_), inverter(rows[1], file_, problems_);
  device("dc line", f.text(0, ""), first, {rectifier.integer(0, "IPR"), inverter.integer(0, "IPI")},
         scheduled(f));
}

/// Returns the scheduled consumption of a two-terminal dc line at its rectifier and its inverter [pu].
/// Fields: MDC (1: power, 2: current), RDC [ohm], SETVL [MW or A], VSCHD [kV]. A negative SETVL is the power
/// at the inverter.
std::vector<double> RawReader::scheduled(Fields& f) const {
  const int mode = f.integer(1, "MDC", 0);
  const long double r = f.number(2, "RDC", 0.0L), set = f.number(3, "SETVL", 0.0L),
                    kv = f.number(4, "VSCHD", 0.0L);
  if ((mode != 1 && mode != 2) || !(kv > 0)) return {};
  const long double ka = mode == 1 ? std::abs(set) / kv : std::abs(set) / 1000.0L;
  const long double mw = mode == 1 ? std::abs(set) : ka * kv, loss = r * ka * ka;
  const bool by_inverter = mode == 1 && set < 0;
  return {pu(by_inverter ? mw + loss : mw), -pu(by_inverter ? mw : mw - loss)};
}

void RawReader::vsc_dc(const Record& first) {
  Fields f(first, file_, problems_);
  const auto rows = following(first, 2, "a voltage source converter dc line");
  if (rows.size() < 2 || f.integer(1, "MDC", 1) == 0) return;
  std::vector<int> buses;
  std::vector<double> powers;
  for (const Record& row : rows) {
    Fields converter(row, file_, problems_);
    const int type = converter.integer(1, "TYPE", 0);  // 1: controls the dc voltage, 2: delivers DCSET [MW]
    if (type == 0) continue;
    buses.push_back(converter.integer(0, "IBUS"));
    powers.push_back(type == 2 ? -pu(converter.number(3, "DCSET", 0.0L))
                               : std::numeric_limits<double>::quiet_NaN());
  }
  device("VSC dc line", f.text(0, ""), first, buses, powers);
}

void RawReader::multi_terminal_dc(const Record& first) {
  Fields f(first, file_, problems_);
  constexpr int most = 1000;  // maximum number of converters, dc buses and lines
  const auto count = [&](std::size_t i, const char* name) {
    return static_cast<std::size_t>(std::clamp(f.integer(i, name, 0), 0, most));
  };
  const std::size_t converters = count(1, "NCONV");
  const auto rows =
      following(first, converters + count(2, "NDCBS") + count(3, "NDCLN"), "a multi-terminal dc line");
  if (rows.size() < converters || f.integer(4, "MDC", 0) == 0) return;
  std::vector<int> buses;
  for (std::size_t i = 0; i < converters; ++i)
    buses.push_back(Fields(rows[i], file_, problems_).integer(0, "IB"));
  device("multi-terminal dc line", f.text(0, ""), first, buses);
}

void RawReader::facts(const Record& record) {
  Fields f(record, file_, problems_);
  if (f.integer(3, "MODE", 1) == 0) return;
  device("FACTS device", f.text(0, ""), record, {f.integer(1, "I"), f.integer(2, "J", 0)});
}

void RawReader::gne(const Record& first) {
  Fields f(first, file_, problems_);
  constexpr int most = 100;
  const auto terminals = static_cast<std::size_t>(std::clamp(f.integer(2, "NTERM", 1), 1, 2));
  std::size_t lines = 1;  // status line; then ten values per line
  for (std::size_t i = 0; i < 3; ++i)
    lines += static_cast<std::size_t>(
                 std::clamp(f.integer(3 + terminals + i, "NREAL, NINTG, NCHAR", 0), 0, most) + 9) /
             10;
  const auto rows = following(first, lines, "a GNE device");
  if (rows.size() < lines || Fields(rows[0], file_, problems_).integer(0, "STATUS", 1) == 0) return;
  std::vector<int> buses;
  for (std::size_t i = 0; i < terminals; ++i) buses.push_back(f.integer(3 + i, "BUS"));
  device("GNE device", f.text(0, ""), first, buses);
}

void RawReader::induction_machine(const Record& record) {
  Fields f(record, file_, problems_);
  if (f.integer(2, "STATUS", 1) == 0) return;
  device("induction machine", f.text(1, "1"), record, {f.integer(0, "bus number")});
}

}  // namespace swingbank::sim::formats::psse
