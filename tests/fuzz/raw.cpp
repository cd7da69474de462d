// PSS/E .raw: bytes -> network -> power flow, and back to bytes.
#include "tests/fuzz/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network network;
  if (!fuzz::accepted([&] { network = sim::formats::parse_raw(text, "case.raw"); })) return 0;
  fuzz::check_power_flow(network);
  fuzz::check_round_trip(network);
  return 0;
}
