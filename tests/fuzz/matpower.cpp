// MATPOWER .m: bytes -> network -> power flow.
#include "sim/formats/matpower.hpp"

#include "tests/fuzz/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network network;
  if (!fuzz::accepted([&] { network = sim::formats::parse_matpower(text, "case.m", 60.0); })) return 0;
  fuzz::check_power_flow(network);
  return 0;
}
