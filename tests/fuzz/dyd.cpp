// PSLF .dyd: bytes -> records in the form of a .dyr -> lines of a .dyd -> records again.
#include "sim/formats/dyd.hpp"

#include "tests/fuzz/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  using namespace swingbank::sim::formats;
  fuzz::quiet();
  const DydSurvey survey =
      parse_dyd_survey(std::string(reinterpret_cast<const char*>(data), size), "case.dyd");
  (void)fuzz::accepted([&] { (void)chosen_records(survey, "case.dyd", {}); });
  for (const DyrRecord& record : survey.dyr.records) {
    if (!record.faults.empty()) continue;
    const auto machine = survey.machines.find(record.line);
    Problems problems;
    const std::string line =
        dyd_line(record, machine == survey.machines.end() ? DydMachine{} : machine->second, {"BUS", 20.0},
                 "here", problems);
    if (!problems.empty()) continue;
    const DydSurvey again = parse_dyd_survey(line, "again.dyd");
    fuzz::require(again.dyr.faults.empty() && again.dyr.records.size() == 1, "what was written can be read");
  }
  return 0;
}
