// Checksummed files: content survives a round trip, and every changed byte is detected before the content is
// used.
#include "base/sealed_file.hpp"

#include <gmock/gmock.h>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"

namespace swingbank {
namespace {

using ::testing::HasSubstr;

constexpr SealedKind kTestKind{"sealed test file", "swingbank-test-1\n", "make it again"};

/// Reads the file. Returns its error message, or its arrays as text.
std::string outcome(const std::filesystem::path& file) {
  std::vector<std::vector<float>> arrays;
  bool taken = false;
  try {
    const auto start = [&](const nlohmann::json& header, std::size_t n) {
      taken = true;
      EXPECT_EQ(header.at("epoch"), 3);
      arrays.resize(n);
    };
    const auto place = [&](std::size_t i, std::size_t n) -> std::span<float> {
      arrays[i].resize(n);
      return arrays[i];
    };
    if (!read_sealed(kTestKind, file, start, place)) return "no file";
  } catch (const InputError& error) {
    EXPECT_FALSE(taken) << "the content was passed on before its checksum was verified";
    return error.what();
  }
  std::string text;
  for (const auto& a : arrays)
    for (const float v : a) text += std::to_string(static_cast<int>(v)) + " ";
  return text;
}

TEST(SealedFile, DetectsEveryFlippedOrMissingByte) {
  const auto write_at_once = [](const std::filesystem::path& at, const std::string& text) {
    std::ofstream(at, std::ios::binary) << text;  // without waiting for the disk
  };
  const auto folder = std::filesystem::temp_directory_path() / ("sealed-" + std::to_string(::getpid()));
  make_folder(folder);
  const auto file = folder / "f.sealed";
  EXPECT_EQ(outcome(file), "no file");
  const std::vector<float> one = {1, 2, 3}, two = {4};
  write_sealed(kTestKind, file, {{"epoch", 3}}, {one, two});
  EXPECT_EQ(outcome(file), "1 2 3 4 ");
  const std::string whole = read_text(file);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ (1 << i % 8));
    write_at_once(file, changed);
    EXPECT_THAT(outcome(file), HasSubstr("cannot be used")) << "byte " << i;
    write_at_once(file, whole.substr(0, i));
    EXPECT_THAT(outcome(file), HasSubstr("cannot be used")) << "cut off at " << i;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace swingbank
