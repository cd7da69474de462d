#pragma once
// The reader of .raw files, section by section. Used by psse_raw.cpp and psse_transformer.cpp only.
#include <array>
#include <map>
#include <set>

#include "sim/network/psse.hpp"
#include "sim/network/psse_text.hpp"

namespace swingbank::sim::psse {

class RawReader {
 public:
  explicit RawReader(const std::filesystem::path& file) : file_(file.string()), lines_(read_lines(file)) {}
  Network read();

 private:
  enum class Use { read, skip, refuse };
  struct Section {
    const char* name;
    Use use;
    void (RawReader::*row)(const Record&) = nullptr;
    int since = 32;  ///< first version that has it
  };
  static const std::array<Section, 19> kSections;

  void header();
  /// False if the file is over ('Q' or no more lines); the latter is a fault unless all sections were seen.
  bool section(const Section& section);
  std::optional<Record> next();
  void bus(const Record& record);
  void load(const Record& record);
  void fixed_shunt(const Record& record);
  void generator(const Record& record);
  void branch(const Record& record);
  void transformer(const Record& first);
  void switched_shunt(const Record& record);
  void finish();

  /// Index of the bus with this number; -1 and a problem if the file has none.
  int find_bus(int number, const Fields& fields);
  /// Notes a repeated identity ("load '1' at bus 5").
  void once(const std::string& identity, const Fields& fields);
  bool status(int value, const char* name, const Fields& fields);
  double pu(long double mw) const { return static_cast<double>(mw / base_); }
  void two_windings(const std::array<Record, 4>& rows, int from, int to);
  struct Ratio;

  std::string file_;
  std::vector<std::string> lines_;
  std::size_t at_ = 0;  ///< next line
  int version_ = 0;
  long double base_ = 100.0L;
  Network network_;
  Problems problems_;
  std::map<int, int> index_;
  std::map<std::string, int> seen_;  ///< identity -> line
  std::map<std::size_t, int> generator_line_;
};

}  // namespace swingbank::sim::psse
