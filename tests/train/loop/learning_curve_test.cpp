// Learning curves: CSV, TensorBoard records read back by their specification, chart, and growing files.
#include "train/loop/learning_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>

#include "base/durable.hpp"

namespace swingbank::train::loop {
namespace {

LearningCurve example() { return {{1, 0.5, 0.4, 1e-3}, {2, 0.25, 0.1, 5e-4}, {300, 0.125, 0.2, 1e-4}}; }

/// CRC-32C by its definition, bit by bit, masked as TFRecord requires.
std::uint32_t masked_crc(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78U : 0U);
  }
  crc = ~crc;
  return (crc >> 15 | crc << 17) + 0xa282ead8U;
}

template <class Number>
Number number(std::string_view bytes, std::size_t at) {
  Number value;
  if (at + sizeof(value) > bytes.size()) throw std::runtime_error("too short");
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// Returns the events of a file. Throws if a length or a checksum is wrong.
std::vector<std::string> events(std::string_view bytes) {
  std::vector<std::string> all;
  while (!bytes.empty()) {
    const auto length = number<std::uint64_t>(bytes, 0);
    if (number<std::uint32_t>(bytes, 8) != masked_crc(bytes.substr(0, 8))) throw std::runtime_error("length");
    all.emplace_back(bytes.substr(12, length));
    if (number<std::uint32_t>(bytes, 12 + length) != masked_crc(all.back()))
      throw std::runtime_error("event");
    bytes.remove_prefix(16 + length);
  }
  return all;
}

/// Fields of a protocol buffer: number -> contents; fixed and variable-length numbers as their bytes.
std::multimap<int, std::string> fields(std::string_view bytes) {
  std::multimap<int, std::string> all;
  const auto variable = [&] {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const auto c = static_cast<unsigned char>(bytes.at(0));
      bytes.remove_prefix(1);
      value |= static_cast<std::uint64_t>(c & 0x7f) << shift;
      if (c < 0x80) return value;
    }
  };
  while (!bytes.empty()) {
    const std::uint64_t tag = variable();
    std::size_t length = 0;
    if ((tag & 7) == 0) {
      const std::uint64_t value = variable();
      all.emplace(static_cast<int>(tag >> 3), std::to_string(value));
      continue;
    }
    length = (tag & 7) == 1 ? 8 : (tag & 7) == 5 ? 4 : variable();
    all.emplace(static_cast<int>(tag >> 3), std::string(bytes.substr(0, length)));
    bytes.remove_prefix(length);
  }
  return all;
}

TEST(LearningCurve, CsvHasOneLinePerEpoch) {
  EXPECT_EQ(learning_curve_csv(example()),
            "epoch,training_loss,validation_loss,learning_rate\n"
            "1,0.5,0.4,0.001\n2,0.25,0.1,0.0005\n300,0.125,0.2,0.0001\n");
}

TEST(LearningCurve, TensorboardRecordsAreReadBack) {
  const auto all = events(tensorboard_events(example()));
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(fields(all[0]).find(3)->second, "brain.Event:2");
  const auto last = fields(all[3]);
  EXPECT_EQ(number<double>(last.find(1)->second, 0), 300.0);
  EXPECT_EQ(last.find(2)->second, "300");  // two bytes
  std::map<std::string, float> scalars;
  const auto summary = fields(last.find(5)->second);
  for (const auto& [field, content] : summary) {
    EXPECT_EQ(field, 1);
    const auto value = fields(content);
    scalars[value.find(1)->second] = number<float>(value.find(2)->second, 0);
  }
  EXPECT_EQ(scalars, (std::map<std::string, float>{
                         {"loss/training", 0.125F}, {"loss/validation", 0.2F}, {"learning_rate", 1e-4F}}));
}

TEST(LearningCurve, ChartMarksTheBestEpoch) {
  const std::string chart = learning_curve_chart(example());
  EXPECT_NE(chart.find("0.5 |."), std::string::npos) << chart;
  EXPECT_NE(chart.find("0.1 |"), std::string::npos) << chart;
  EXPECT_NE(chart.find("best (0.1, epoch 2)"), std::string::npos) << chart;
  EXPECT_EQ(std::ranges::count(chart, '*'), 2);  // in the chart and in its legend
  EXPECT_NE(learning_curve_chart({{1, -0.5, -1.5, 1e-3}}).find("epoch 1"), std::string::npos);
  EXPECT_EQ(learning_curve_chart({}), "");
}

TEST(LearningCurve, GrowingFilesEqualThoseWrittenAtOnce) {
  const auto folder = std::filesystem::temp_directory_path() / ("curves-" + std::to_string(::getpid()));
  const auto read = [&](const std::string& name) { return read_text(folder / name); };
  LearningCurve growing;
  LearningCurveFiles files(folder, "run");
  for (const EpochErrors& e : example()) {
    growing.push_back(e);
    files.write(growing);
  }
  LearningCurveFiles(folder, "resumed").write(example());
  const std::string events_file = "/events.out.tfevents.0000000000.swingbank";
  EXPECT_EQ(read("run.csv"), learning_curve_csv(example()));
  EXPECT_EQ(read("run.csv"), read("resumed.csv"));
  EXPECT_EQ(read("run" + events_file), tensorboard_events(example()));
  EXPECT_EQ(read("run" + events_file), read("resumed" + events_file));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace swingbank::train::loop
