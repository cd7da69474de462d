// Reader of .rawx files: the tables of version 35 as JSON. Every row is converted to a record of a .raw, so
// that both formats share the readers of equipment. Source: PSS/E data format manual, "Extensible Power Flow
// Data File".

#include "base/json.hpp"
#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats::psse {
namespace {

using Json = nlohmann::json;

/// Fields of a record in the order of a .raw, version 35; nullptr: not read.
using Names = std::vector<const char*>;
const char* const kSkip = nullptr;

const Names kBus{"ibus", "name", "baskv", "ide", "area", "zone", "owner", "vm", "va"};
const Names kLoad{"ibus", "loadid", "stat",  "area",  "zone",   "pl",    "ql",    "ip",   "iq",
                  "yp",   "yq",     "owner", "scale", "intrpt", "dgenp", "dgenq", "dgenm"};
const Names kShunt{"ibus", "shntid", "stat", "gl", "bl"};
const Names kGenerator{"ibus",  "machid", "pg", "qg", "qt", "qb",   "vs",   "ireg", "nreg",
                       "mbase", "zr",     "zx", "rt", "xt", "gtap", "stat", "rmpct"};
const Names kLine{"ibus", "jbus", "ckt", "rpu", "xpu", "bpu", kSkip, kSkip, kSkip, kSkip, kSkip, kSkip,
                  kSkip,  kSkip,  kSkip, kSkip, kSkip, kSkip, kSkip, "gi",  "bi",  "gj",  "bj",  "stat"};
const Names kSwitch{"ibus", "jbus", "ckt", "xpu", kSkip, kSkip, kSkip, kSkip, kSkip,
                    kSkip,  kSkip,  kSkip, kSkip, kSkip, kSkip, kSkip, "stat"};
const Names kSwitched{"ibus", "shntid", "modsw", "adjm", "stat", "vswhi", "vswlo", "swreg", kSkip,
                      kSkip,  kSkip,    "binit", "s1",   "n1",   "b1",    "s2",    "n2",    "b2",
                      "s3",   "n3",     "b3",    "s4",   "n4",   "b4",    "s5",    "n5",    "b5",
                      "s6",   "n6",     "b6",    "s7",   "n7",   "b7",    "s8",    "n8",    "b8"};
const std::vector<Names> kTransformer{
    {"ibus", "jbus", "kbus", "ckt", "cw", "cz", "cm", "mag1", "mag2", kSkip, kSkip, "stat"},
    {"r1_2", "x1_2", "sbase1_2", "r2_3", "x2_3", "sbase2_3", "r3_1", "x3_1", "sbase3_1", "vmstar", "anstar"}};

class Table {
 public:
  Table(const Json& network, const char* name, const std::string& file, Problems& problems)
      : name_(name), file_(file), problems_(problems) {
    const auto found = network.find(name);
    if (found == network.end()) return;
    if (!found->is_object() || !found->contains("fields") || !found->contains("data") ||
        !(*found)["fields"].is_array() || !(*found)["data"].is_array()) {
      wrong("the table has no fields and data");
      return;
    }
    std::size_t i = 0;
    for (const Json& field : (*found)["fields"])
      if (field.is_string()) place_.emplace(field.get<std::string>(), i++);
    rows_ = &(*found)["data"];
    if (!rows_->empty() && !(*rows_)[0].is_array()) {  // a parameter set: one row without outer brackets
      one_ = Json::array({*rows_});
      rows_ = &one_;
    }
  }
  [[nodiscard]] std::size_t size() const { return rows_ ? rows_->size() : 0; }
  [[nodiscard]] bool has(const std::string& field) const { return place_.contains(field); }
  Field field(std::size_t row, const std::string& name) {
    const auto found = place_.find(name);
    const Json& values = (*rows_)[row];
    if (found == place_.end() || !values.is_array() || found->second >= values.size()) return {};
    const Json& value = values[found->second];
    if (value.is_null()) return {};
    if (value.is_string()) {
      const std::string text = value.get<std::string>();
      const auto first = text.find_first_not_of(' ');
      return {first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1),
              true};
    }
    if (value.is_number()) return {value.dump(), false};
    wrong("row " + std::to_string(row + 1) + " contains values other than numbers and strings");
    return {};
  }
  Record record(std::size_t row, const Names& names, const std::string& suffix = "") {
    Record r;
    r.place = file_ + ", " + name_ + " " + std::to_string(row + 1);
    for (const char* name : names) r.fields.push_back(name ? field(row, name + suffix) : Field{});
    return r;
  }

 private:
  void wrong(const std::string& what) {
    problems_.add(what, file_ + ", table " + name_,
                  "a .rawx table is {\"fields\": [...], \"data\": [[...], ...]}", "save the case again");
  }
  std::string name_, file_;
  Problems& problems_;
  std::map<std::string, std::size_t> place_;
  const Json* rows_ = nullptr;
  Json one_;
};

/// Returns one winding of a transformer as a line of a .raw.
Record winding(Table& table, std::size_t row, const std::string& number) {
  Record r = table.record(row, {"windv", "nomv", "ang"}, number);
  r.fields.resize(columns(35).winding_table);
  r.fields.push_back(table.field(row, "tab" + number));
  return r;
}

}  // namespace

void RawReader::read_json() {
  std::string text;
  for (const std::string& line : lines_) text += line + "\n";
  const Json whole = Json::parse(text, nullptr, false);
  if (whole.is_discarded() || !whole.is_object() || !whole.contains("network") ||
      !whole["network"].is_object())
    throw InputError({"no object \"network\"", file_, "a .rawx is JSON with this object",
                      "save the case again; the file may be truncated"});
  const Json& net = whole["network"];
  Table head(net, "caseid", file_, problems_);
  Record header = head.size() ? head.record(0, {"ic", "sbase", "rev", kSkip, kSkip, "basfrq"}) : Record{};
  header.place = file_ + ", caseid";
  version_ = 35;  // version of the converted records
  columns_ = columns(version_);
  Fields f(header, file_, problems_);
  base_ = static_cast<double>(f.number(1, "SBASE", 100.0L));
  if (f.text(5, "").empty() && !options_.frequency_hz && options_.needs_frequency)
    throw InputError({"BASFRQ is missing", f.where(), "the swing equations need the system frequency",
                      "give it with --frequency-hz, 50 or 60 Hz"});
  check_header(f, f.integer(0, "IC", 0),
               static_cast<double>(f.number(5, "BASFRQ", options_.frequency_hz.value_or(1.0))));
  network_.title = (head.size() ? head.field(0, "title1").text : "") + "\n" +
                   (head.size() ? head.field(0, "title2").text : "");

  const auto rows = [&](const char* name, const Names& names, void (RawReader::*row)(const Record&)) {
    Table table(net, name, file_, problems_);
    section_ = name;
    for (std::size_t i = 0; i < table.size(); ++i) {
      (this->*row)(table.record(i, names));
      generator_line_.resize(network_.generators.size(), static_cast<int>(i) + 1);
      branch_line_.resize(network_.branches.size(), static_cast<int>(i) + 1);
    }
  };
  rows("bus", kBus, &RawReader::bus);
  rows("load", kLoad, &RawReader::load);
  rows("fixshunt", kShunt, &RawReader::fixed_shunt);
  rows("generator", kGenerator, &RawReader::generator);
  rows("acline", kLine, &RawReader::branch);
  rows("sysswd", kSwitch, &RawReader::switching_device);
  json_transformers(net);
  rows("swshunt", kSwitched, &RawReader::switched_shunt);
  json_devices(net);
  json_substations(net);
}

/// Reads the substations: the rows of the last three tables refer to a row of the first by isub.
void RawReader::json_substations(const nlohmann::json& net) {
  std::map<int, Substation> all;
  const auto rows = [&](const char* name, const Names& names,
                        const std::function<void(Substation&, const Record&)>& row) {
    Table table(net, name, file_, problems_);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Record key = table.record(i, {"isub"});
      row(all[Fields(key, file_, problems_).integer(0, "isub")], table.record(i, names));
    }
  };
  rows("sub", {"name"},
       [&](Substation& s, const Record& r) { s.name = Fields(r, file_, problems_).text(0, ""); });
  rows("subnode", {"inode", "name", "ibus", "stat"}, [&](Substation& s, const Record& r) { node(s, r); });
  rows("subswd", {"inode", "jnode", "swdid", "name", "type", "stat"},
       [&](Substation& s, const Record& r) { node_switch(s, r); });
  rows("subterm", {"ibus", "inode"}, [&](Substation& s, const Record& r) { terminal(s, r); });
  for (const auto& [number, station] : all) check_substation(station);
}

void RawReader::json_transformers(const nlohmann::json& net) {
  section_ = "transformer";
  Table table(net, "transformer", file_, problems_);
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::vector<Record> lines;
    for (const Names& names : kTransformer) lines.push_back(table.record(i, names));
    for (const char* number : {"1", "2", "3"}) lines.push_back(winding(table, i, number));
    transformer_lines(lines);
    branch_line_.resize(network_.branches.size(), static_cast<int>(i) + 1);
  }
  Table corrections(net, "impcor", file_, problems_);
  for (std::size_t i = 0; i < corrections.size(); ++i) {  // a row is one point
    const Record point = corrections.record(i, {"itable", "tap", "refact", "imfact"});
    Fields f(point, file_, problems_);
    const int number = f.integer(0, "itable");
    const auto tap = static_cast<double>(f.number(1, "tap", 0.0L));
    auto& points = tables_[number];
    if (!points.empty() && tap < points.back().first) unsorted(number, f);
    points.emplace_back(tap, Complex(static_cast<double>(f.number(2, "refact", 0.0L)),
                                     static_cast<double>(f.number(3, "imfact", 0.0L))));
  }
}

/// Reads the buses of equipment without a model.
void RawReader::json_devices(const nlohmann::json& net) {
  struct Kind {
    const char *table, *kind, *name, *status;
    std::vector<const char*> buses;
  };
  const std::vector<Kind> kinds{{"twotermdc", "dc line", "name", "mdc", {"ipr", "ipi"}},
                                {"vscdc", "VSC dc line", "name", "mdc", {"ibus1", "ibus2"}},
                                {"facts", "FACTS device", "name", "mode", {"ibus", "jbus"}},
                                {"gne", "GNE device", "name", "stat", {"bus1", "bus2"}},
                                {"ntermdcconv", "multi-terminal dc line", "name", "", {"ib"}},
                                {"indmach", "induction machine", "imid", "stat", {"ibus"}}};
  for (const Kind& kind : kinds) {
    section_ = kind.table;
    Table table(net, kind.table, file_, problems_);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Record record = table.record(i, {kind.name, kind.status});
      Fields f(record, file_, problems_);
      if (*kind.status && f.integer(1, kind.status, 1) == 0) continue;
      std::vector<int> buses;
      for (const char* name : kind.buses) {
        const Record bus = table.record(i, {name});
        buses.push_back(Fields(bus, file_, problems_).integer(0, name, 0));
      }
      std::vector<double> powers;
      if (std::string_view(kind.table) == "twotermdc") {
        const Record line = table.record(i, {"name", "mdc", "rdc", "setvl", "vschd"});
        Fields of(line, file_, problems_);
        powers = scheduled(of);
      }
      device(kind.kind, f.text(0, ""), record, buses, powers);
    }
  }
}

}  // namespace swingbank::sim::formats::psse
