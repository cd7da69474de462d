// PSLF .epc: bytes -> network -> power flow; repeated equipment refused, then omitted.
#include "sim/formats/pslf_epc.hpp"
#include "tests/fuzz/check.hpp"

using namespace swingbank;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network strict, lenient;
  bool whole = false;
  const auto read = [&](const sim::formats::RawOptions& o) {
    return sim::formats::parse_epc(text, "case.epc", o);
  };
  if (!fuzz::read_both_ways(read, sim::formats::RawOptions(60.0), strict, lenient, whole)) return 0;
  fuzz::check_power_flow(lenient);
  return 0;
}
