// PSS/E .raw and .rawx: bytes -> network -> power flow, and back to bytes; with equipment that appears twice
// refused, and left out.
#include "tests/fuzz/check.hpp"

namespace {

using namespace swingbank;

/// What a header leaves out is given, as by the options: the layout of version 23 has no REV and no BASFRQ.
bool read(const std::string& text, bool drop_repeated, sim::network::Network& network) {
  sim::formats::RawOptions options(60.0, 23);
  options.drop_repeated = drop_repeated;
  const char* const name = text.starts_with("{") ? "case.rawx" : "case.raw";
  return fuzz::accepted([&] { network = sim::formats::parse_raw(text, name, options); });
}

std::string as_text(const sim::network::Network& network) {
  std::string text;
  (void)fuzz::accepted([&] { text = sim::formats::raw_text(network, 35, "written"); });
  return text;
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
  if (whole) fuzz::require(as_text(strict) == as_text(lenient), "nothing is left out of what is whole");
  fuzz::check_power_flow(lenient);
  fuzz::check_round_trip(lenient);
  return 0;
}
