// Records as text: bytes -> record -> its checks.
#include "validate/record/record.hpp"

#include "tests/fuzz/check.hpp"
#include "validate/check/check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const std::string text(reinterpret_cast<const char*>(data), size);
  validate::record::Record record;
  if (!fuzz::accepted([&] { record = validate::record::parse_record(text, "r.csv", {100, 60, 138}); }))
    return 0;
  for (const auto* c : {&record.V, &record.theta, &record.P, &record.Q})
    fuzz::require(c->size() == record.t.size(), "channels are as long as the times");
  for (std::size_t k = 1; k < record.t.size(); ++k)
    fuzz::require(record.t[k] > record.t[k - 1], "times increase");
  for (const auto& f : validate::check::check_record(record, {100, 60}))
    fuzz::require(
        !f.kind.empty() && !f.problem.what.empty() && !f.problem.why.empty() && !f.problem.remedy.empty(),
        "a finding says what, why and what to do");
  return 0;
}
