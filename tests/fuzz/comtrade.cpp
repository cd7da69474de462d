// COMTRADE: bytes as a .cff (configuration and data in one) -> samples -> record -> its checks.
#include "validate/record/comtrade.hpp"

#include "tests/fuzz/check.hpp"
#include "validate/check/check.hpp"
#include "validate/record/formats.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  validate::record::Comtrade comtrade;
  if (!fuzz::accepted([&] { comtrade = validate::record::parse_cff(bytes, "e.cff"); })) return 0;
  for (const auto& c : comtrade.channels)
    fuzz::require(c.values.size() == comtrade.t.size(), "channels are as long as the times");
  validate::record::Record record;
  if (!fuzz::accepted([&] {
        record = validate::record::record_of_comtrade(comtrade, "e.cff", {100, 60, 138}, {});
      }))
    return 0;
  for (const auto* c : {&record.V, &record.theta, &record.P, &record.Q})
    fuzz::require(c->size() == record.t.size(), "channels are as long as the times");
  validate::check::check_record(record, {100, 60});
  return 0;
}
