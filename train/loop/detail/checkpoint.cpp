#include "train/loop/detail/checkpoint.hpp"

#include "base/json.hpp"
#include "base/sealed_file.hpp"

namespace swingbank::train::loop {
namespace {
using nlohmann::json;
constexpr SealedKind kCheckpoint{
    "checkpoint", "swingbank-checkpoint-1\n",
    "remove the file to train this run from the beginning, or use another output folder"};
}  // namespace

void write_checkpoint(const std::filesystem::path& file, const json& header,
                      const std::vector<std::span<const float>>& arrays) {
  write_sealed(kCheckpoint, file, header, arrays);
}

bool read_checkpoint(const std::filesystem::path& file, const json& run, json& header,
                     const std::vector<std::span<float>>& arrays) {
  const auto start = [&](const json& found, std::size_t count) {
    json its = found.value("run", json());
    for (const char* maker : {"software", "kernels"})
      if (its.is_object() && run.is_object() && run.value(maker, "") == "any") its[maker] = "any";
    if (its != run) throw Unusable{"it belongs to a run with other data, settings, software or kernels"};
    if (count != arrays.size()) throw Unusable{"its number of arrays differs"};
    header = found;
  };
  return read_sealed(kCheckpoint, file, start, [&](std::size_t i, std::size_t size) {
    if (size != arrays[i].size()) throw Unusable{"the length of an array differs"};
    return arrays[i];
  });
}

}  // namespace swingbank::train::loop
