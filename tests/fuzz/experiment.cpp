// Experiment files: bytes -> presets, networks, tasks.
#include "train/loop/experiment.hpp"

#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"
#include "train/networks/network.hpp"

namespace swingbank::train::networks {
const std::vector<NetworkRecord>& all_networks() {
  static const std::vector<NetworkRecord> list = {
      {"cnn", nullptr}, {"gru", nullptr}, {"lstm", nullptr}, {"mlp", nullptr}};
  return list;
}
}  // namespace swingbank::train::networks

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const auto file = fuzz::in_a_file({reinterpret_cast<const char*>(data), size}, "x.toml");
  train::loop::Experiment experiment;
  if (!fuzz::accepted([&] { experiment = train::loop::read_experiment(file); })) return 0;
  for (const auto& [name, preset] : experiment.presets)
    fuzz::accepted([&, &of = name] {
      const auto tasks = experiment.tasks(of);
      fuzz::require(!tasks.empty(), "a preset has tasks");
      for (const char* key : train::loop::kPrintable) (void)experiment.print(of, key);
    });
  return 0;
}
