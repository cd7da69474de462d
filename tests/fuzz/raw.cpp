// PSS/E .raw and .rawx: bytes -> network -> power flow, and back to bytes; repeated equipment refused, then
// omitted.
#include "tests/fuzz/check.hpp"

namespace {

using namespace swingbank;

std::string as_text(const sim::network::Network& network) { return sim::formats::raw_text(network, 35); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network strict, lenient;
  bool whole = false;
  const char* const name = text.starts_with("{") ? "case.rawx" : "case.raw";
  const auto read = [&](const sim::formats::RawOptions& o) { return sim::formats::parse_raw(text, name, o); };
  // Missing values of the header are given by options: the layout of version 23 has no REV and no BASFRQ.
  if (!fuzz::read_both_ways(read, sim::formats::RawOptions(60.0, 23), strict, lenient, whole)) return 0;
  if (whole)
    fuzz::require(as_text(strict) == as_text(lenient),
                  "no equipment is omitted from a network without repeated equipment");
  fuzz::check_power_flow(lenient);
  fuzz::check_round_trip(lenient);
  return 0;
}
