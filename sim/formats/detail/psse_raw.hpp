#pragma once
// Reader of .raw files, section by section. Used only by psse_*.cpp.
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "sim/formats/detail/network_reader.hpp"

namespace swingbank::sim::formats::psse {

/// Columns, counted from 0, of the fields whose position depends on the version. Version 34 has twelve
/// ratings in place of three in branches and transformer windings. Version 34 also adds a name to branches
/// and appends the regulated node NREG to generators and switched shunts. Version 35 moves NREG next to the
/// regulated bus and adds an id to switched shunts. Switched shunts have no status before version 32, no
/// RMPCT before 30 and no RMIDNT before
/// 28. Before 28, branch records also describe transformers. Source: PSS/E data format manuals, "Power Flow
/// Data"; for 24 to 28 MATPOWER, psse_parse.m.
struct Columns {
  std::size_t gen_base, gen_status;          ///< MBASE (ZR, ZX, RT, XT, GTAP follow), STAT (RMPCT follows)
  std::size_t branch_shunts, branch_status;  ///< GI (BI, GJ, BJ follow), ST
  std::size_t winding_table;                 ///< TAB1
  std::size_t switched_id;                   ///< 1 if an ID precedes MODSW, else 0
  std::size_t switched_status, switched_binit;
  std::size_t bus_area, bus_voltage, bus_owner;  ///< AREA (ZONE follows), VM (VA follows)
};
constexpr std::size_t kNoColumn = 999;  ///< beyond the end of every record: the field takes its default
constexpr Columns columns(int version) {
  if (version >= 35) return {9, 15, 19, 23, 23, 1, 4, 11, 4, 7, 6};
  if (version == 34) return {8, 14, 19, 23, 22, 0, 3, 9, 4, 7, 6};
  if (version >= 32) return {8, 14, 9, 13, 13, 0, 3, 9, 4, 7, 6};
  if (version == 31) return {8, 14, 9, 13, 13, 0, kNoColumn, 7, 4, 7, 6};
  if (version >= 28) return {8, 14, 9, 13, 13, 0, kNoColumn, version == 30 ? 7u : 6u, 6, 8, 10};
  if (version >= 24) return {8, 14, 11, 15, 13, 0, kNoColumn, 5, 6, 8, 10};
  return {8, 14, 11, 15, 13, 0, kNoColumn, 5, 6, 7, kNoColumn};
}

/// Reader of one .raw or .rawx; each object reads one file.
class RawReader : NetworkReader {
 public:
  /// `name` replaces the file name in messages.
  RawReader(std::vector<std::string> lines, std::string name, const RawOptions& options)
      : NetworkReader(std::move(lines), std::move(name), options) {}
  network::Network read();
  RawSurvey survey();
  /// Returns the number of errors found when the file is read as this version, whatever its header says.
  /// Reading stops after more than `most` errors. The reader cannot be used afterwards.
  std::size_t faults_as(int version, std::size_t most);
  /// Returns the version used for reading; 0: the header has none.
  [[nodiscard]] int version() const { return version_; }

 private:
  void read_sections();
  struct Section {
    const char* name;
    void (RawReader::*row)(const Record&) = nullptr;  ///< null: ignored section
  };
  /// Returns the sections of a version in file order.
  [[nodiscard]] std::vector<Section> sections() const;
  void read_json();
  void json_transformers(const nlohmann::json& network);
  void json_devices(const nlohmann::json& network);
  void json_substations(const nlohmann::json& network);

  void header();
  void check_header(const Fields& header, int change, double frequency);
  void check_titles();
  /// Reads a section. Returns false at the end of the file ('Q' or no more lines). A file that ends without
  /// 'Q' is an error unless only optional sections are missing.
  bool section(const Section& section, bool may_be_missing);
  /// Returns true if the file has no such section. Some programs write version 34 without the section of
  /// switching devices: the line that ends the branch section then announces the transformers.
  [[nodiscard]] bool left_out(const Section& section) const;
  /// Returns true if the comment on the line that ended a section announces the same section again.
  [[nodiscard]] bool again(const Section& section) const;
  /// Returns the next record that has fields. Lines that begin with '@!' are comments.
  std::optional<Record> next();
  /// Makes next() return `record` again; it must be the last record that next() returned.
  void put_back(const Record& record) { at_ = static_cast<std::size_t>(record.line) - 1; }

  void system_wide(const Record& record);
  void bus(const Record& record);
  void bus_23(const Record& record);
  void bus_shunt(Fields& f, std::size_t first);
  void load(const Record& record);
  void fixed_shunt(const Record& record);
  void generator(const Record& record);
  void branch(const Record& record);
  void switching_device(const Record& record);
  void transformer(const Record& first);
  void transformer_lines(std::span<const Record> rows);
  void switched_shunt(const Record& record);
  void switching(Fields& f, const network::Shunt& shunt);
  void correction_table(const Record& first);
  void unsorted(int table, const Fields& fields);
  void two_terminal_dc(const Record& first);
  std::vector<double> scheduled(Fields& line) const;
  void vsc_dc(const Record& first);
  void multi_terminal_dc(const Record& first);
  void facts(const Record& record);
  void gne(const Record& first);
  void induction_machine(const Record& record);
  void substation(const Record& first);
  void finish();
  [[nodiscard]] std::string generator_place(std::size_t i) const {
    return i < places_.size() ? places_[i] : file_ + ":" + std::to_string(generator_line_[i]);
  }
  void correct_impedances();

  /// Returns the `count` continuation records after `first`; fewer, with a problem, at the end of the
  /// section. `what`: name of the equipment in messages.
  std::vector<Record> following(const Record& first, std::size_t count, const char* what);
  void device(const std::string& kind, const std::string& name, const Record& record,
              const std::vector<int>& numbers, const std::vector<double>& scheduled = {});

  /// Returns the circuit id of a branch (Identities::id). Branches from A to B and from B to A share their
  /// ids.
  std::optional<std::string> circuit_of(int from, int to, const std::string& circuit, const Fields& fields);

  struct Codes;  ///< data codes CW, CZ, CM of a transformer
  Codes codes(Fields& head);
  void two_windings(std::span<const Record> rows, int from, int to);
  void three_windings(std::span<const Record> rows, const std::array<int, 3>& ends);
  /// Stores the reference of a winding to its correction table; the tables are read later.
  void note_table(Fields& winding, std::size_t number, std::size_t branch);
  Complex magnetising(Fields& head, Fields& winding, const Codes& codes, long double mva,
                      const network::Bus& bus);

  struct Substation {
    struct Node {
      int bus, root;  ///< root: parent in the union-find forest, initially the node itself
    };
    std::string name;
    std::map<int, Node> nodes;
    std::map<int, std::string> terminals;  ///< node with equipment -> place of its row in messages
    int root(int node) const;
  };
  bool part_of_substation(const char* name, const std::function<void(const Record&)>& row);
  bool has_node(const Substation& station, int node, const Fields& fields);
  void node(Substation& station, const Record& record);
  void node_switch(Substation& station, const Record& record);
  void terminal(Substation& station, const Record& record);
  void check_substation(const Substation& station);

  std::size_t at_ = 0;     ///< next line
  std::string separator_;  ///< line that ended the last section
  int version_ = 0, forced_ = 0;
  std::size_t most_faults_ = std::numeric_limits<std::size_t>::max();  ///< reading stops after more errors
  Columns columns_{};
  std::vector<std::string> places_;  ///< places of the generators in messages, for a .rawx
  std::vector<int> regulated_;       ///< of each generator: number of the regulated bus, 0: its own
  struct Correction {
    std::size_t branch;
    int table;
    std::string name;     ///< TAB1 to TAB3
    double ratio, angle;  ///< unconverted WINDV, ANG [deg]
    std::string where;
  };
  std::vector<Correction> corrections_;
  std::map<int, std::vector<std::pair<double, Complex>>> tables_;  ///< points (T, factor), T ascending
};

/// Returns a problem that names the likely version if the file has at least three errors in the version used
/// and at most a tenth as many in another version.
std::optional<Problem> other_version(const std::vector<std::string>& lines, const std::string& name,
                                     const RawOptions& options, int read_as,
                                     const std::vector<Problem>& faults);

}  // namespace swingbank::sim::formats::psse
