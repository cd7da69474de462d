// A dataset's header and journal: first line as dataset.json, the others as journal, each with a valid
// checksum -> contents and errors of the named shards.
#include "mpi/store/dataset.hpp"

#include "base/sealed_text.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::string header, journal;
  for (bool first = true; !rest.empty(); first = false) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    // A text that is no object is used unchanged, as a damaged file.
    const bool object = line.size() > 2 && line.front() == '{' && line.back() == '}';
    (first ? header : journal) += object ? sealed_text(line) : std::string(line) + "\n";
  }
  fuzz::in_a_file(header, "dataset.json");
  fuzz::in_a_file(journal, "journal.jsonl");
  fuzz::accepted([&] { mpi::store::open_dataset(fuzz::folder(), true); });
  fuzz::accepted(
      [&] { mpi::store::require_machines(mpi::store::read_header(fuzz::folder()), fuzz::folder()); });
  Problems damaged;
  fuzz::accepted([&] { mpi::store::read_journals(fuzz::folder(), &damaged); });
  return 0;
}
