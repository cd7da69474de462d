#include "train/loop/learning_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <boost/crc.hpp>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/write_file.hpp"

namespace swingbank::train::loop {
namespace {

constexpr std::string_view kHeading = "epoch,training_loss,validation_loss,learning_rate\n";

std::string csv_lines(const LearningCurve& curve, std::size_t begin) {
  std::string text;
  for (std::size_t k = begin; k < curve.size(); ++k) {
    const EpochErrors& e = curve[k];
    text += fmt::format("{},{},{},{}\n", e.epoch, e.training, e.validation, e.learning_rate);
  }
  return text;
}

/// Returns the bytes of a little-endian number.
template <class Number>
std::string bytes_of(Number value) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes(sizeof(value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(value));
  return bytes;
}
std::string variable_length(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(0x80 | (value & 0x7f));
  return bytes + static_cast<char>(value);
}
/// Returns a length-delimited field of a protocol buffer.
std::string field(char number, const std::string& content) {
  return static_cast<char>(number << 3 | 2) + variable_length(content.size()) + content;
}
/// Returns TensorFlow's masked CRC-32C.
std::uint32_t masked_crc(const std::string& bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  const std::uint32_t value = crc.checksum();
  return (value >> 15 | value << 17) + 0xa282ead8U;
}
std::string record(const std::string& event) {
  const std::string length = bytes_of<std::uint64_t>(event.size());
  return length + bytes_of(masked_crc(length)) + event + bytes_of(masked_crc(event));
}
/// Returns fields 1 and 2 of an Event: time [s] and step. Both are set to the epoch.
std::string at(std::size_t epoch) {
  return "\x09" + bytes_of(static_cast<double>(epoch)) + "\x10" + variable_length(epoch);
}
std::string scalar(const std::string& tag, double value) {
  return field(1, field(1, tag) + "\x15" + bytes_of(static_cast<float>(value)));
}

void append(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out << text << std::flush;
  if (!out)
    throw InputError({"the learning curve cannot be written", file.string(), std::strerror(errno),
                      "check space and permissions there, then run the same command again"});
}

}  // namespace

nlohmann::json learning_curve_json(const LearningCurve& curve) {
  nlohmann::json all = nlohmann::json::array();
  for (const EpochErrors& e : curve)
    all.push_back({{"epoch", e.epoch},
                   {"training_loss", e.training},
                   {"validation_loss", e.validation},
                   {"learning_rate", e.learning_rate}});
  return all;
}

LearningCurve read_learning_curve(const nlohmann::json& curve) {
  LearningCurve all;
  for (const auto& e : curve)
    all.push_back({e.at("epoch"), e.at("training_loss"), e.at("validation_loss"), e.at("learning_rate")});
  return all;
}

std::string learning_curve_csv(const LearningCurve& curve) {
  return std::string(kHeading) + csv_lines(curve, 0);
}

std::string tensorboard_events(const LearningCurve& curve, std::size_t begin) {
  std::string text;
  if (begin == 0) text = record(at(0) + field(3, "brain.Event:2"));
  for (std::size_t k = begin; k < curve.size(); ++k) {
    const EpochErrors& e = curve[k];
    text += record(at(e.epoch) +
                   field(5, scalar("loss/training", e.training) + scalar("loss/validation", e.validation) +
                                scalar("learning_rate", e.learning_rate)));
  }
  return text;
}

std::string learning_curve_chart(const LearningCurve& curve, std::size_t columns) {
  constexpr std::size_t kChartRows = 12, kLabelWidth = 10;
  if (curve.empty()) return {};
  double low = curve.front().validation, high = low;
  std::size_t best = 0;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    low = std::min({low, curve[k].training, curve[k].validation});
    high = std::max({high, curve[k].training, curve[k].validation});
    if (curve[k].validation < curve[best].validation) best = k;
  }
  const auto axis = [&](double value) { return low > 0.0 ? std::log(value) : value; };
  const std::size_t width = std::max<std::size_t>(columns, kLabelWidth + 20) - kLabelWidth;
  std::vector<std::string> rows(kChartRows, std::string(width, ' '));
  const auto put = [&](std::size_t k, double value, char mark) {
    const double x = curve.size() > 1 ? static_cast<double>(k) / static_cast<double>(curve.size() - 1) : 0.0;
    const double y = high > low ? (axis(high) - axis(value)) / (axis(high) - axis(low)) : 0.0;
    rows[static_cast<std::size_t>(std::lround(y * (kChartRows - 1)))]
        [static_cast<std::size_t>(std::lround(x * static_cast<double>(width - 1)))] = mark;
  };
  for (std::size_t k = 0; k < curve.size(); ++k) put(k, curve[k].training, '.');
  for (std::size_t k = 0; k < curve.size(); ++k) put(k, curve[k].validation, 'o');
  put(best, curve[best].validation, '*');
  std::string text;
  for (std::size_t r = 0; r < kChartRows; ++r) {
    const std::string label = r == 0                ? fmt::format("{:.3g}", high)
                              : r + 1 == kChartRows ? fmt::format("{:.3g}", low)
                                                    : "";
    text += fmt::format("{:>{}} |{}\n", label, kLabelWidth - 2, rows[r]);
  }
  text += fmt::format("{:>{}} +{:-<{}}\n", "", kLabelWidth - 2, "", width);
  return text +
         fmt::format("{:>{}}  epoch 1 to {}; loss: . training, o validation, * best ({:.4g}, epoch {})\n", "",
                     kLabelWidth - 2, curve.size(), curve[best].validation, curve[best].epoch);
}

LearningCurveFiles::LearningCurveFiles(std::filesystem::path folder, std::string run)
    : csv_(folder / (run + ".csv")), events_(folder / run / "events.out.tfevents.0000000000.swingbank") {}

void LearningCurveFiles::write(const LearningCurve& curve) {
  if (written_ == 0 || curve.size() < written_) {
    make_folder(events_.parent_path().parent_path());
    make_folder(events_.parent_path());
    write_file(csv_, learning_curve_csv(curve));
    write_file(events_, tensorboard_events(curve));
  } else {
    append(csv_, csv_lines(curve, written_));
    append(events_, tensorboard_events(curve, written_));
  }
  written_ = curve.size();
}

}  // namespace swingbank::train::loop
