// Checkpoints: every changed byte is detected.
#include "train/loop/detail/checkpoint.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"

namespace swingbank::train::loop {
namespace {

TEST(Checkpoint, DetectsEveryFlippedByte) {
  const auto folder = std::filesystem::temp_directory_path() / ("checkpoint-" + std::to_string(::getpid()));
  make_folder(folder);
  const auto file = folder / "run.checkpoint";
  const nlohmann::json run = {{"seed", 1}, {"data", "0123456789abcdef"}, {"software", "swingbank"}};
  std::vector<float> weights(200, 0.25F), moments(100, 1e-3F);
  write_checkpoint(file, {{"run", run}, {"epoch", 7}, {"best", 0.5}}, {weights, moments});
  const auto read = [&] {
    nlohmann::json header;
    return read_checkpoint(file, run, header, {weights, moments});
  };
  ASSERT_TRUE(read());
  const std::string whole = read_text(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ (1 << i % 8));
    std::ofstream(file, std::ios::binary) << changed;  // without waiting for the disk
    EXPECT_THROW(read(), InputError) << "byte " << i;
  }
  write_text(file, whole);
  EXPECT_TRUE(read());
  RecordProperty("flipped", static_cast<int>(whole.size()));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace swingbank::train::loop
