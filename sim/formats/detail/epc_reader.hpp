#pragma once
// Reader of .epc files, section by section. Used only by pslf_epc*.cpp.
#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "sim/formats/detail/network_reader.hpp"

namespace swingbank::sim::formats::epc {

/// A record: the equipment before the colon (`of`) and its values after it (`says`).
struct Row {
  psse::Record of, says;
  std::vector<std::size_t> starts;  ///< per continuation line: number of `says` fields before it
};

/// Reader of one .epc; each object reads one file.
class EpcReader : NetworkReader {
 public:
  /// `name` replaces the file name in messages.
  EpcReader(std::vector<std::string> lines, std::string name, const RawOptions& options)
      : NetworkReader(std::move(lines), std::move(name), options) {}
  network::Network read();
  RawSurvey survey();

 private:
  struct Section {
    std::string name;         ///< "bus", "dc converter"
    int announced;            ///< announced number of records
    std::size_t first, last;  ///< indices of its lines, from 0; `last` excluded
  };
  using Reads = void (EpcReader::*)(const Row&);

  void divide();
  /// Returns the lines between a block's title at line `at` and '!', and advances `at` past the block.
  std::vector<std::string> block(std::size_t& at) const;
  void solution_parameters(const std::vector<std::string>& block, std::size_t first);
  void read_sections();
  void rows(const char* name, Reads take);
  void report_left_out();

  void bus(const Row& row);
  void load(const Row& row);
  void shunt(const Row& row);
  void line_shunt(psse::Fields& of, psse::Fields& f, Complex y);
  void svd(const Row& row);
  void steps_of(const Row& row, const network::Shunt& shunt, int regulated, psse::Fields& f);
  void generator(const Row& row);
  void converter(const Row& row);
  void branch(const Row& row);
  void join_sections();
  void transformer(const Row& row);
  void two_windings(const std::string& circuit, psse::Fields& f, int from, int to, bool on);
  void three_windings(const std::string& circuit, psse::Fields& f, const std::array<int, 3>& ends, bool on);
  Complex magnetising(psse::Fields& f, int bus);

  bool status(psse::Fields& f) { return NetworkReader::status(f.integer(0, "st"), "st", f); }
  [[nodiscard]] static std::string id_of(const psse::Fields& of, std::size_t i);
  [[nodiscard]] std::string place(int line) const { return file_ + ":" + std::to_string(line); }

  /// One section of a transmission line; `section`: its number, from 1.
  struct Part {
    network::Branch branch;
    int section, line;
  };

  std::vector<Section> sections_;
  std::vector<double> vsched_;  ///< scheduled voltage of each bus [pu]
  std::map<std::tuple<int, int, std::string>, std::vector<Part>>
      parts_;                                             ///< (ends, circuit) -> line sections
  std::vector<std::tuple<int, int, std::string>> order_;  ///< keys of parts_ in file order
};

}  // namespace swingbank::sim::formats::epc
