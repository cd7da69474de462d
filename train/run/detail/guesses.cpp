#include "train/run/detail/guesses.hpp"

#include <fmt/format.h>

#include <numeric>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/run_lock.hpp"
#include "base/sealed_file.hpp"
#include "train/direct/direct.hpp"
#include "train/loop/progress.hpp"

namespace swingbank::train::run {
namespace {

using nlohmann::json;
constexpr SealedKind kGuesses{"file of starting estimates", "swingbank-guesses-1\n",
                              "remove it; it is then computed again"};
constexpr auto kPatience = std::chrono::hours(12);  ///< longest wait for another process

/// Reads the file. Returns false if it does not exist.
bool read(const std::filesystem::path& file, const json& identity, std::size_t size,
          std::vector<float>& values) {
  values.resize(size);
  return read_sealed(
      kGuesses, file,
      [&](const json& header, std::size_t arrays) {
        if (header != identity || arrays != 1) throw Unusable{"it belongs to other data or another method"};
      },
      [&](std::size_t, std::size_t found) -> std::span<float> {
        if (found != size) throw Unusable{"its number of rows differs"};
        return values;
      });
}

std::vector<float> make(const data::ShardStream& stream, const std::string& method, bool quiet) {
  loop::TrainingProgress progress(method + " of all rows", stream.labels().rows, quiet);
  std::vector<float> all;
  const auto append = [&](const mpi::store::Dataset& d, std::uint64_t first) {
    std::vector<std::uint64_t> rows(d.rows);
    std::iota(rows.begin(), rows.end(), first);
    const auto found = direct::estimate(d, rows, method, stream.noise(), [&](std::size_t done) {
      progress.update(first + done, "rows estimated");
    });
    all.insert(all.end(), found.begin(), found.end());
  };
  append(stream.dataset(), 0);
  if (stream.more()) append(*stream.more(), stream.dataset().rows);
  return all;
}

}  // namespace

std::vector<float> guesses(const data::ShardStream& stream, const std::string& method,
                           const std::string& maker, const std::filesystem::path& folder, bool quiet) {
  const data::NoiseRecipe& noise = stream.noise();
  const json identity = {{"method", method},
                         {"software", maker},
                         {"dataset", stream.dataset().hash},
                         {"training_dataset", stream.more() ? stream.more()->hash : ""},
                         {"noise", noise.level},
                         {"noise_seed", noise.level > 0 ? noise.seed : 0}};
  const std::string more = stream.more() ? stream.more()->hash : "none";
  const auto file =
      folder / fmt::format("guesses-{}-{}-{}-noise{:g}-seed{}-{}.bin", method, stream.dataset().hash, more,
                           noise.level, noise.level > 0 ? noise.seed : 0, maker.substr(maker.rfind(' ') + 1));
  const std::size_t size = stream.labels().rows * stream.labels().parameters;
  std::vector<float> values;
  if (read(file, identity, size, values)) return values;
  RunLock lock(file.string() + ".lock",
               {"file of starting estimates in use", file.string(), "wait until that run ends"}, kPatience);
  if (!read(file, identity, size, values)) {
    values = make(stream, method, quiet);
    write_sealed(kGuesses, file, identity, {values});
  }
  lock.withdraw(true);
  return values;
}

}  // namespace swingbank::train::run
