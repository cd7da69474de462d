#pragma once
// The reader of .raw files, section by section. Used by psse_*.cpp only.
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <span>

#include "sim/formats/detail/identities.hpp"
#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/consistency.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::formats::psse {

/// Where the fields whose place depends on the version stand (counted from 0). Version 34 puts twelve ratings
/// and a name into branches and transformer windings and appends the regulated node; version 35 moves the
/// node beside the regulated bus and gives switched shunts an id; before 32 switched shunts have no status,
/// before 30 no RMPCT, before 28 no RMIDNT, and transformers stand among the branches. Source: PSS/E data
/// format manuals, "Power Flow Data"; for 24 to 28 MATPOWER, psse_parse.m.
struct Columns {
  std::size_t gen_base, gen_status;          ///< MBASE (ZR, ZX, RT, XT, GTAP follow), STAT (RMPCT follows)
  std::size_t branch_shunts, branch_status;  ///< GI (BI, GJ, BJ follow), ST
  std::size_t winding_table;                 ///< TAB1
  std::size_t switched_id;                   ///< 1 if an ID stands before MODSW, else 0
  std::size_t switched_status, switched_binit;
  std::size_t bus_area, bus_voltage, bus_owner;  ///< AREA (ZONE follows), VM (VA follows)
};
constexpr std::size_t kNoColumn = 999;  ///< beyond every record: the default holds
constexpr Columns columns(int version) {
  if (version >= 35) return {9, 15, 19, 23, 23, 1, 4, 11, 4, 7, 6};
  if (version == 34) return {8, 14, 19, 23, 22, 0, 3, 9, 4, 7, 6};
  if (version >= 32) return {8, 14, 9, 13, 13, 0, 3, 9, 4, 7, 6};
  if (version == 31) return {8, 14, 9, 13, 13, 0, kNoColumn, 7, 4, 7, 6};
  if (version >= 28) return {8, 14, 9, 13, 13, 0, kNoColumn, version == 30 ? 7u : 6u, 6, 8, 10};
  if (version >= 24) return {8, 14, 11, 15, 13, 0, kNoColumn, 5, 6, 8, 10};
  return {8, 14, 11, 15, 13, 0, kNoColumn, 5, 6, 7, kNoColumn};
}

class RawReader {
 public:
  /// `name` stands for the file in messages.
  RawReader(std::vector<std::string> lines, std::string name, const RawOptions& options)
      : file_(std::move(name)), lines_(std::move(lines)), options_(options) {}
  RawReader(const RawReader&) = delete;
  network::Network read();
  RawSurvey survey();
  /// How many faults the file has if it is read as this version, whatever its header says; it is read no
  /// further once there are more than `most`. The reader is of no use after that.
  std::size_t faults_as(int version, std::size_t most);
  /// The version it was read as; 0: the header did not say it.
  [[nodiscard]] int version() const { return version_; }

 private:
  void read_sections();
  struct Section {
    const char* name;
    void (RawReader::*row)(const Record&) = nullptr;  ///< none: passed over
  };
  /// The sections of a version in their order.
  [[nodiscard]] std::vector<Section> sections() const;
  void read_json();
  void json_transformers(const nlohmann::json& network);
  void json_devices(const nlohmann::json& network);

  void header();
  void check_header(const Fields& header, int change, double frequency);
  void check_titles();
  /// False if the file is over ('Q' or no more lines); the latter is a fault unless only sections are missing
  /// that may be.
  bool section(const Section& section, bool may_be_missing);
  /// Some programs write version 34 without this section: the line that ends the branches says so.
  [[nodiscard]] bool left_out(const Section& section) const;
  /// Whether the line that ended a section says that the same begins again.
  [[nodiscard]] bool again(const Section& section) const;
  /// The next record that holds a field; lines that begin with '@!' are comments.
  std::optional<Record> next();
  /// Steps back by the record that next() returned last.
  void put_back(const Record& record) { at_ = static_cast<std::size_t>(record.line) - 1; }

  void system_wide(const Record& record);
  void bus(const Record& record);
  void bus_23(const Record& record);
  void bus_shunt(Fields& f, std::size_t first);
  void raise_impedance(network::Branch& b, const Fields& f);
  void load(const Record& record);
  void fixed_shunt(const Record& record);
  void generator(const Record& record);
  /// The generator holds its own bus at the voltage in the file, with a remark.
  void hold_own(network::Generator& g, const char* what, const std::string& where);
  void branch(const Record& record);
  void switching_device(const Record& record);
  void transformer(const Record& first);
  void transformer_lines(std::span<const Record> rows);
  void switched_shunt(const Record& record);
  void switching(Fields& f, const network::Shunt& shunt);
  void correction_table(const Record& first);
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

  /// The `count` records after `first`, which belong to it; fewer where the section ends.
  std::vector<Record> following(const Record& first, std::size_t count, const char* what);
  void device(const std::string& kind, const std::string& name, const Record& record,
              const std::vector<int>& numbers, const std::vector<double>& scheduled = {});

  /// Index of the bus with this number; -1 and a problem or a remark if the file has none.
  int find_bus(int number, const Fields& fields) {
    return identities_.bus_index(index_, number, section_, fields);
  }
  /// The circuit that a branch bears, in either direction: Identities::id.
  std::optional<std::string> circuit_of(int from, int to, const std::string& circuit, const Fields& fields);
  bool status(int value, const char* name, const Fields& fields);
  double pu(long double mw) const { return static_cast<double>(mw / base_); }
  [[nodiscard]] const network::Bus& at(int bus) const {
    return network_.buses[static_cast<std::size_t>(bus)];
  }

  struct Codes;  ///< CW, CZ, CM of a transformer
  Codes codes(Fields& head);
  void two_windings(std::span<const Record> rows, int from, int to);
  void three_windings(std::span<const Record> rows, const std::array<int, 3>& ends);
  int star_point(const std::string& circuit, Fields& impedances, const std::array<int, 3>& ends,
                 bool in_service);
  /// The correction table that a winding names, kept until the tables are read.
  void note_table(Fields& winding, std::size_t number, std::size_t branch);
  Complex magnetising(Fields& head, Fields& winding, const Codes& codes, long double mva,
                      const network::Bus& bus);

  struct Substation;
  bool part_of_substation(const char* name, const std::function<void(const Record&)>& row);
  void check_substation(const Substation& station);

  std::string file_;
  std::vector<std::string> lines_;
  std::size_t at_ = 0;     ///< next line
  std::string separator_;  ///< the line that ended the last section
  int version_ = 0, forced_ = 0;
  std::size_t most_faults_ = std::numeric_limits<std::size_t>::max();  ///< more end the reading
  Columns columns_{};
  long double base_ = 100.0L;
  network::Network network_;
  Problems problems_;
  std::map<int, int> index_;
  std::vector<int> generator_line_, branch_line_;
  std::vector<std::string> places_;  ///< of the generators, where they are not lines
  bool units_only_ = false;          ///< what matters to a network alone is no fault
  RawOptions options_;
  Identities identities_{options_, network_, problems_};
  std::string section_;  ///< whose records are being read
  std::vector<network::Device> devices_;
  std::vector<int> regulated_;  ///< per generator: number of the bus it holds, 0: its own
  struct Correction {
    std::size_t branch;
    int table;
    std::string name;     ///< TAB1 to TAB3
    double ratio, angle;  ///< WINDV as in the file, ANG [deg]
    std::string where;
  };
  std::vector<Correction> corrections_;
  std::map<int, std::vector<std::pair<double, Complex>>> tables_;  ///< T and factor, ascending
  std::set<int> stars_;  ///< indices of the star points of three-winding transformers
};

/// Where a file has many faults as the version that it was read as, and hardly any as another: that.
std::optional<Problem> other_version(const std::vector<std::string>& lines, const std::string& name,
                                     const RawOptions& options, int read_as,
                                     const std::vector<Problem>& faults);

}  // namespace swingbank::sim::formats::psse
