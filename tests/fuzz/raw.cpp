// PSS/E .raw and .rawx: bytes -> network -> power flow, and back to bytes.
#include "tests/fuzz/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network network;
  // What a header leaves out is given, as by the options: the layout of version 23 has no REV and no BASFRQ.
  const char* const name = text.starts_with("{") ? "case.rawx" : "case.raw";
  if (!fuzz::accepted([&] { network = sim::formats::parse_raw(text, name, {60.0, 23}); })) return 0;
  fuzz::check_power_flow(network);
  fuzz::check_round_trip(network);
  return 0;
}
