// PSLF .epc: bytes -> network -> power flow; with equipment that appears twice refused, and left out.
#include "sim/formats/pslf_epc.hpp"
#include "tests/fuzz/check.hpp"

namespace {

using namespace swingbank;

bool read(const std::string& text, bool drop_repeated, sim::network::Network& network) {
  sim::formats::RawOptions options(60.0);
  options.drop_repeated = drop_repeated;
  return fuzz::accepted([&] { network = sim::formats::parse_epc(text, "case.epc", options); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::network::Network strict, lenient;
  const bool whole = read(text, false, strict);
  if (!read(text, true, lenient)) {
    fuzz::require(!whole, "what is whole is read with either option");
    return 0;
  }
  fuzz::check_power_flow(lenient);
  (void)fuzz::accepted([&] { (void)sim::formats::raw_text(lenient, 33, "written"); });
  return 0;
}
