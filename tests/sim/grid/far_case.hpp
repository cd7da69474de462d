#pragma once
// Converter plant whose control measures at a remote bus or branch.
#include <fmt/format.h>

#include <string>

#include "sim/grid/grid.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid::far_control {

/// Bus 102 is the point of common coupling; the converter is at bus 104 behind a transformer.
inline formats::RawCase behind_a_branch() {
  formats::RawCase raw;
  raw.buses =
      "101,'NORTH', 138.0,3,1,1,1,1.05,0.0,1.1,0.9,1.1,0.9\n"
      "102,'POINT',138.0,1,1,1,1,1.02,-0.9,1.1,0.9,1.1,0.9\n"
      "103,'SOUTH',138.0,1,1,1,1,0.99,-8.7,1.1,0.9,1.1,0.9\n"
      "104,'PLANT',138.0,2,1,1,1,1.03,3.0,1.1,0.9,1.1,0.9\n";
  raw.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,200,0,0.3,0,0,1,1,100,318,0,1,1\n"
      "104,'1',80.0,0.0,50,-50,1.03,0,100,0,9999.0,0,0,1,1,100,318,0,1,1\n";
  raw.branches += "102,104,'1',0.0,0.08,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  return raw;
}
/// The same case with the transformer in the generator's own record.
inline formats::RawCase behind_its_own_transformer(double P, double volts) {
  formats::RawCase raw = behind_a_branch();
  raw.buses.erase(raw.buses.find("104,"));
  raw.buses.replace(raw.buses.find("138.0,1,"), 8, "138.0,2,");
  raw.generators.erase(raw.generators.find("104,"));
  raw.branches.erase(raw.branches.find("102,104,"));
  raw.generators +=
      fmt::format("102,'1',{:.17g},0.0,99,-99,{:.17g},0,100,0,9999.0,0,0.08,1,1,100,318,0,1,1\n", P, volts);
  return raw;
}
struct Control {
  std::string codes = "102 102 103 '1'", flags = "1 1 1", droop = "0.01 0.03 0.02";
  std::string bus = "104";
};
inline std::string plants(const Control& control) {
  return "101 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8 /\n" + control.bus +
         " 'REGCA1' 1 0 0.02 10 0.9 0.4 1.22 1.2 0.9 0.5 -1.3 0.2 0 100 -100 0 /\n" + control.bus +
         " 'REECB1' 1 0 0 0 0 0 -99 99 0.02 -0.01 0.01 0 1.1 -1.1 0 0 0.6 -0.6 1.05 0.9 0 0.01 10 60 0.02 99 "
         "-99 1.2 0 1.11 0.02 /\n" +
         control.bus + " 'REPCA1' 1 " + control.codes + " " + control.flags + " 0.02 2.0 4.0 0 0.05 0.5 " +
         control.droop + " 0.1 -0.1 0 0 0.6 -0.6 0.5 0.3 0.25 -0.0004 0.0004 99 -99 1.2 0 0.1 10 10 /\n";
}
inline Grid load_from(const formats::RawCase& raw, const std::string& dyr) {
  const formats::ScratchFile r("case.raw", raw.text()), d("case.dyr", dyr);
  return load_grid(r.path, d.path, Conventions::psse());
}

}  // namespace swingbank::sim::grid::far_control
