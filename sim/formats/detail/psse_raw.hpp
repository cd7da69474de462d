#pragma once
// The reader of .raw files, section by section. Used by psse_*.cpp only.
#include <array>
#include <functional>
#include <map>
#include <set>
#include <span>

#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats::psse {

/// Where the fields whose place depends on the version stand (counted from 0). Version 34 puts twelve ratings
/// and a name into branches and transformer windings and appends the regulated node; version 35 moves the
/// node beside the regulated bus and gives switched shunts an id. Source: PSS/E data format manuals, "Power
/// Flow Data".
struct Columns {
  std::size_t gen_base, gen_status;          ///< MBASE (ZR, ZX, RT, XT, GTAP follow), STAT
  std::size_t branch_shunts, branch_status;  ///< GI (BI, GJ, BJ follow), ST
  std::size_t winding_table;                 ///< TAB1
  std::size_t switched_id;                   ///< 1 if an ID stands before MODSW, else 0
  std::size_t switched_status, switched_binit;
};
constexpr Columns columns(int version) {
  if (version >= 35) return {9, 15, 19, 23, 23, 1, 4, 11};
  if (version == 34) return {8, 14, 19, 23, 22, 0, 3, 9};
  return {8, 14, 9, 13, 13, 0, 3, 9};
}

class RawReader {
 public:
  /// `name` stands for the file in messages.
  RawReader(std::vector<std::string> lines, std::string name)
      : file_(std::move(name)), lines_(std::move(lines)) {}
  network::Network read();
  RawSurvey survey(std::optional<double> frequency_hz);

 private:
  void read_sections();
  enum class Use { read, skip, refuse };
  struct Section {
    const char* name;
    Use use;
    void (RawReader::*row)(const Record&) = nullptr;
    int since = 32;  ///< first version that has it
  };
  static const std::array<Section, 22> kSections;

  void header();
  /// False if the file is over ('Q' or no more lines); the latter is a fault unless all sections were seen.
  bool section(const Section& section);
  /// Some programs write version 34 without this section: the line that ends the branches says so.
  [[nodiscard]] bool left_out(const Section& section) const;
  /// The next record that holds a field; lines that begin with '@!' are comments.
  std::optional<Record> next();
  /// Steps back by the record that next() returned last.
  void put_back(const Record& record) { at_ = static_cast<std::size_t>(record.line) - 1; }

  void system_wide(const Record& record);
  void bus(const Record& record);
  void load(const Record& record);
  void fixed_shunt(const Record& record);
  void generator(const Record& record);
  void branch(const Record& record);
  void switching_device(const Record& record);
  void transformer(const Record& first);
  void switched_shunt(const Record& record);
  void substation(const Record& first);
  void finish();

  /// Index of the bus with this number; -1 and a problem if the file has none.
  int find_bus(int number, const Fields& fields);
  /// Notes a repeated identity ("load '1' at bus 5").
  void once(const std::string& identity, const Fields& fields);
  /// The same for a branch, in either direction.
  void once_branch(int from, int to, const std::string& circuit, const Fields& fields);
  bool status(int value, const char* name, const Fields& fields);
  double pu(long double mw) const { return static_cast<double>(mw / base_); }
  [[nodiscard]] const network::Bus& at(int bus) const {
    return network_.buses[static_cast<std::size_t>(bus)];
  }

  struct Codes;  ///< CW, CZ, CM of a transformer
  Codes codes(Fields& head);
  void two_windings(std::span<const Record> rows, int from, int to);
  void three_windings(std::span<const Record> rows, const std::array<int, 3>& ends);
  int star_point(Fields& head, Fields& impedances, const std::array<int, 3>& ends, bool in_service);
  void no_table(Fields& winding, std::size_t number);
  Complex magnetising(Fields& head, Fields& winding, const Codes& codes, long double mva,
                      const network::Bus& bus);

  struct Substation;
  bool part_of_substation(const char* name, const std::function<void(const Record&)>& row);
  void check_substation(const Substation& station);

  std::string file_;
  std::vector<std::string> lines_;
  std::size_t at_ = 0;     ///< next line
  std::string separator_;  ///< the line that ended the last section
  int version_ = 0;
  Columns columns_{};
  long double base_ = 100.0L;
  network::Network network_;
  Problems problems_;
  std::map<int, int> index_;
  std::map<std::string, int> seen_;  ///< identity -> line
  std::vector<int> generator_line_, branch_line_;
  bool units_only_ = false;  ///< what matters to a network alone is no fault
  std::optional<double> frequency_hz_;
  std::set<int> stars_;  ///< indices of the star points of three-winding transformers
};

}  // namespace swingbank::sim::formats::psse
