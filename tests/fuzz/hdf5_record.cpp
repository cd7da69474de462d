// Records in HDF5: bytes as a file -> samples of one plant.
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"
#include "validate/record/formats.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  ::setenv("SWINGBANK_READER_SECONDS", "2", 1);  // a damaged file may cause an endless loop in its reader
  const auto file = fuzz::in_a_file({reinterpret_cast<const char*>(data), size}, "r.h5");
  validate::record::Record record;
  if (!fuzz::accepted([&] { record = validate::record::read_hdf5_record(file, {100, 60, 138}, {}); }))
    return 0;
  for (const auto* c : {&record.V, &record.theta, &record.P, &record.Q})
    fuzz::require(c->size() == record.t.size(), "channels are as long as the times");
  return 0;
}
