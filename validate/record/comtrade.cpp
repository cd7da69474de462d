#include "validate/record/comtrade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "validate/record/detail/build.hpp"
#include "validate/record/detail/comtrade_cfg.hpp"
#include "validate/record/detail/text.hpp"

namespace swingbank::validate::record {
namespace {

/// Returns the integer or float at byte `at`. The standard prescribes little-endian order.
template <class T>
T little(std::string_view bytes, std::size_t at) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < sizeof(T); ++k)
    bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
  T value;
  if constexpr (sizeof(T) == 2) {
    const auto narrow = static_cast<std::uint16_t>(bits);
    std::memcpy(&value, &narrow, 2);
  } else {
    std::memcpy(&value, &bits, 4);
  }
  return value;
}

class Data {
 public:
  Data(ComtradeConfig config, std::string_view dat, std::string name, Problems& problems)
      : c_(std::move(config)),
        out_(c_.about),
        dat_(dat),
        problems_(problems),
        faults_([this](std::size_t first, std::size_t last) { return out_.where(first, last); }) {
    out_.file = std::move(name);
  }

  Comtrade read() {
    settle_kind();
    if (out_.kind == "ASCII")
      lines();
    else
      bytes();
    const std::size_t read = out_.places.size(), announced = static_cast<std::size_t>(c_.samples);
    if (read < announced || surplus_ > 0)
      out_.notes.push_back(
          fmt::format("The configuration announces {} samples, the data hold {}: the first {} were read.",
                      announced, read + surplus_, read));
    unwrap_stamps();
    times();
    faults_.report(problems_, out_.file);
    return std::move(out_);
  }

 private:
  /// Returns the size of a sample with values of `width` bytes [bytes].
  [[nodiscard]] std::size_t sample_size(std::size_t width) const {
    return 8 + width * out_.channels.size() + 2 * ((static_cast<std::size_t>(c_.status) + 15) / 16);
  }
  /// Returns whether the first 16 samples are numbered consecutively, if a sample has `size` bytes.
  [[nodiscard]] bool counts_up(std::size_t size) const {
    constexpr std::size_t kLooked = 16;
    const std::size_t n = std::min(kLooked, dat_.size() / size);
    for (std::size_t k = 1; k < n; ++k)
      if (little<std::uint32_t>(dat_, k * size) != little<std::uint32_t>(dat_, (k - 1) * size) + 1)
        return false;
    return n > 1;
  }
  /// Returns whether the four-byte values are floats: all finite values except 0 have magnitudes from 1e-15
  /// to 1e15. Integers interpreted as floats are mostly denormal (below 1e-38) or not finite.
  [[nodiscard]] bool contains_floats() const {
    const std::size_t size = sample_size(4), n = dat_.size() / size;
    bool any = false;
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t c = 0; c < out_.channels.size(); ++c) {
        const auto v = std::abs(little<float>(dat_, k * size + 8 + 4 * c));
        if (!std::isfinite(v) || v == 0) continue;
        if (!(v > 1e-15F && v < 1e15F)) return false;
        any = true;
      }
    return any;
  }
  /// Replaces the data type stated in the configuration if the data have another type.
  void settle_kind() {
    const std::string_view head = dat_.substr(0, 200);
    const bool text = head.find_first_not_of("0123456789.,+-eE \t\r\n\x1a") == std::string_view::npos;
    std::string kind = out_.kind;
    if (text)
      kind = "ASCII";
    else if (const bool two = counts_up(sample_size(2)), four = counts_up(sample_size(4)); two != four)
      kind = two ? "BINARY" : contains_floats() ? "FLOAT32" : out_.kind == "FLOAT32" ? out_.kind : "BINARY32";
    if (kind == out_.kind || dat_.empty()) return;
    out_.notes.push_back(
        fmt::format("The configuration states data type {0}, but the data are {1}; they were read as {1}.",
                    out_.kind, kind));
    out_.kind = kind;
  }

  void lines() {
    int number = 0;
    const bool ended = dat_.empty() || dat_.find_last_of("\r\n\x1a") == dat_.size() - 1;
    while (!dat_.empty()) {
      const auto fields = comtrade_fields(take_line(dat_));
      ++number;
      if (fields.size() == 1 && fields[0].empty()) continue;
      if (is_surplus()) continue;
      const std::size_t wanted = 2 + out_.channels.size() + static_cast<std::size_t>(c_.status);
      const bool last = dat_.find_first_not_of(" \t\r\n\x1a") == std::string_view::npos;
      // Without a line end, the last number may be cut off.
      if (last && (fields.size() < wanted || !ended)) {
        note_cut(fmt::format("{}:{}", out_.file, number));
        return;
      }
      const std::size_t sample = begin(static_cast<std::size_t>(number));
      if (fields.size() != wanted)
        faults_.add("fields", fmt::format("{} fields", fields.size()), sample,
                    fmt::format("the configuration requires {} fields", wanted), "export the data again");
      const auto field = [&](std::size_t i) { return i < fields.size() ? fields[i] : std::string_view{}; };
      numbered(sample, comtrade_number(field(0)).value_or(-1));
      stamps_.push_back(comtrade_number(field(1)).value_or(kNoValue));
      for (std::size_t c = 0; c < out_.channels.size(); ++c)
        add(c, text_value(out_.channels[c], field(2 + c), sample));
    }
  }

  /// Parses a value. An empty field is a missing value, and so is 99999 before revision 2013 (clause 8.4).
  double text_value(const ComtradeChannel& channel, std::string_view text, std::size_t sample) {
    const auto v = comtrade_number(text);
    if (!v && !text.empty())
      faults_.add(channel.id, fmt::format("{} = '{}'", channel.id, text), sample, "it is not a number",
                  "export the data again");
    return v && !(out_.revision < 2013 && *v == 99999) ? *v : kNoValue;
  }

  void bytes() {
    const std::size_t width = out_.kind == "BINARY" ? 2 : 4;
    const std::size_t size = sample_size(width), n = dat_.size() / size;
    out_.sample_bytes = size;
    for (std::size_t k = 0; k < n; ++k) {
      if (is_surplus()) continue;
      const std::size_t at = k * size;
      const std::size_t sample = begin(at);
      numbered(sample, little<std::uint32_t>(dat_, at));
      const auto stamp = little<std::uint32_t>(dat_, at + 4);
      stamps_.push_back(stamp == 0xFFFFFFFFU ? kNoValue : stamp);
      for (std::size_t c = 0; c < out_.channels.size(); ++c) add(c, binary_value(at + 8 + width * c));
    }
    if (dat_.size() % size != 0 && n < static_cast<std::size_t>(c_.samples))
      note_cut(fmt::format("{}, byte {}", out_.file, n * size));
  }

  /// Returns whether all announced samples have been read. Counts the surplus ones.
  bool is_surplus() {
    if (out_.places.size() < static_cast<std::size_t>(c_.samples)) return false;
    ++surplus_;
    return true;
  }
  void note_cut(const std::string& where) {
    out_.notes.push_back(fmt::format("The last sample ({}) is truncated and was ignored.", where));
  }

  /// Returns the value at byte `at`; NaN if it is missing. The marks of a missing value are 0x8000 and
  /// 0x80000000 (clause 8.6), a FLOAT32 that is not finite, and the largest FLOAT32.
  [[nodiscard]] double binary_value(std::size_t at) const {
    if (out_.kind == "BINARY") {
      const auto v = little<std::int16_t>(dat_, at);
      return v == std::numeric_limits<std::int16_t>::min() ? kNoValue : v;
    }
    if (out_.kind == "BINARY32") {
      const auto v = little<std::int32_t>(dat_, at);
      return v == std::numeric_limits<std::int32_t>::min() ? kNoValue : v;
    }
    const auto v = little<float>(dat_, at);
    return std::isfinite(v) && std::abs(v) < std::numeric_limits<float>::max() ? v : kNoValue;
  }

  std::size_t begin(std::size_t place) {
    out_.places.push_back(place);
    return out_.places.size() - 1;
  }

  /// Checks that sample numbers are consecutive; each break is reported once.
  void numbered(std::size_t sample, double number) {
    if (sample > 0 && number != next_number_)
      faults_.add("number", fmt::format("sample number {:g}", number), sample,
                  fmt::format("expected {:g}", next_number_),
                  "samples are missing or repeated: fill the gap at the source, or cut the record");
    next_number_ = number + 1;
  }

  void add(std::size_t channel, double x) {
    ComtradeChannel& c = out_.channels[channel];
    const double ratio = c.secondary_values ? c.primary / c.secondary : 1.0;
    c.values.push_back((c.a * x + c.b) * ratio);
  }

  /// Unwraps the time stamps. They are unsigned four-byte numbers, which overflow in a long record.
  void unwrap_stamps() {
    constexpr double kWrap = 4294967296.0;
    double turns = 0, before = kNoValue;
    for (double& stamp : stamps_) {
      if (stamp < before - kWrap / 2) turns += kWrap;
      if (std::isfinite(stamp)) before = stamp;
      stamp += turns;
    }
    if (turns > 0)
      out_.notes.push_back(
          "The time stamps overflow at 2^32, the largest value of the format; they were unwrapped.");
  }

  void times() {
    const std::size_t n = out_.places.size();
    out_.t.resize(n);
    if (!c_.rates.empty()) {
      rated_times(n);
      compare_stamps();
      return;
    }
    out_.resolution = c_.stamp;
    for (std::size_t k = 0; k < n; ++k) {
      out_.t[k] = (stamps_[k] - stamps_[0]) * c_.stamp;
      if (!std::isfinite(out_.t[k]))
        faults_.add("stamp", "no time stamp", k, "the configuration names no sampling rate",
                    "export the record with a rate or with stamps");
    }
  }

  /// Computes times from the rates. The interval before a sample is 1/rate of the stretch that contains it.
  void rated_times(std::size_t n) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < c_.rates.size(); ++i) {
      const auto& [rate, last] = c_.rates[i];
      const std::size_t end = i + 1 == c_.rates.size() ? n : std::min(n, static_cast<std::size_t>(last));
      if (end <= first) continue;
      const double before = first == 0 ? -1.0 / rate : out_.t[first - 1];
      for (std::size_t k = first; k < end; ++k)
        out_.t[k] = before + static_cast<double>(k - first + 1) / rate;
      if (!out_.stretches.empty() && out_.stretches.back().rate == rate)
        out_.stretches.back().end = end;
      else
        out_.stretches.push_back({rate, first, end});
      first = end;
    }
    // With a single rate, k/rate avoids the rounding error of the sum above.
    if (out_.stretches.size() == 1)
      for (std::size_t k = 0; k < n; ++k) out_.t[k] = static_cast<double>(k) / out_.stretches[0].rate;
  }

  /// Compares the stamps with the rate, which has priority (clause 8.3), and notes a difference above 1 %. A
  /// ratio above 9 becomes a problem: the stamps or the rate are then in an unknown unit.
  void compare_stamps() {
    if (stamps_.size() < 2) return;
    const double stamped = (stamps_.back() - stamps_.front()) * c_.stamp, rated = out_.t.back();
    if (!(std::isfinite(stamped) && stamped > 0 && std::abs(stamped - rated) > 0.01 * rated)) return;
    const double intervals = static_cast<double>(stamps_.size() - 1);
    if (stamped > 9 * rated || rated > 9 * stamped)
      problems_.add(
          fmt::format("a sampling rate of {:.6g} per second, but {:.6g} time stamps per second",
                      intervals / rated, intervals / stamped),
          out_.file,
          fmt::format("by the rate the record lasts {:.4g} s, by its stamps {:.4g} s: one of them is "
                      "in another unit",
                      rated, stamped),
          "correct the rate or the time multiplier in the .cfg; to use the time stamps, set the number of "
          "rates and the rate to 0");
    else
      out_.notes.push_back(fmt::format(
          "The time stamps of the data span {:.6g} s, the sampling rate of the configuration {:.6g} s; the "
          "rate was used.",
          stamped, rated));
  }

  ComtradeConfig c_;
  Comtrade out_;
  std::string_view dat_;
  Problems& problems_;
  SampleFaults faults_;
  std::vector<double> stamps_;
  double next_number_ = 1;
  std::size_t surplus_ = 0;  ///< samples beyond the announced number
};

/// Returns the section of a .cff whose heading contains `word`, and sets `heading` to that line.
std::string_view section(std::string_view cff, std::string_view word, std::string& heading) {
  constexpr std::string_view mark = "--- file type:";
  for (auto at = cff.find(mark); at != std::string_view::npos; at = cff.find(mark, at + 1)) {
    std::string_view rest = cff.substr(at);
    heading = take_line(rest);
    if (heading.find(word) == std::string::npos) continue;
    if (heading.find("BINARY") == std::string::npos && heading.find("FLOAT") == std::string::npos)
      return rest.substr(0, rest.find(mark));
    // The heading of binary data contains the number of bytes: "DAT BINARY: 1234 ---".
    const auto colon = heading.rfind(':');
    std::string_view digits = std::string_view(heading).substr(colon + 1);
    digits = comtrade_fields(digits.substr(0, digits.find("---")))[0];
    const auto count = comtrade_number(digits);
    return count && *count >= 0 ? rest.substr(0, static_cast<std::size_t>(std::min(*count, 1e12))) : rest;
  }
  heading.clear();
  return {};
}

}  // namespace

std::string Comtrade::where(std::size_t first, std::size_t last) const {
  if (first >= places.size()) return file;
  last = std::min(last, places.size() - 1);
  if (sample_bytes > 0)
    return fmt::format("{}, bytes {}-{}", file, places[first], places[last] + sample_bytes - 1);
  return first == last ? fmt::format("{}:{}", file, places[first])
                       : fmt::format("{}:{}-{}", file, places[first], places[last]);
}

namespace {
/// Resamples the waveforms of a recorder whose rate follows the grid frequency. They are interpolated at
/// uniform times by cubic polynomials. Returns false if the rates differ by more than 2 %.
bool put_onto_mean_rate(Comtrade& c) {
  constexpr double kDrawn = 0.02;  // relative; above the frequency deviation of any grid
  const auto [low, high] = std::ranges::minmax(c.stretches, {}, &ComtradeStretch::rate);
  const std::size_t n = c.t.size();
  if (high.rate > low.rate * (1 + kDrawn) || n < 4) return false;
  const double rate = static_cast<double>(n - 1) / (c.t.back() - c.t.front());
  std::vector<std::vector<double>> even(c.channels.size(), std::vector<double>(n));
  std::vector<double> t(n);
  std::size_t at = 0;  // index of the preceding sample
  for (std::size_t k = 0; k < n; ++k) {
    t[k] = c.t.front() + static_cast<double>(k) / rate;
    while (at + 2 < n && c.t[at + 1] <= t[k]) ++at;
    const std::size_t first = std::clamp<std::size_t>(at, 1, n - 3) - 1;
    std::array<double, 4> weight{};
    for (std::size_t i = 0; i < 4; ++i) {
      weight[i] = 1;
      for (std::size_t j = 0; j < 4; ++j)
        if (j != i) weight[i] *= (t[k] - c.t[first + j]) / (c.t[first + i] - c.t[first + j]);
    }
    for (std::size_t channel = 0; channel < even.size(); ++channel)
      for (std::size_t i = 0; i < 4; ++i)
        even[channel][k] += weight[i] * c.channels[channel].values[first + i];
  }
  for (std::size_t channel = 0; channel < even.size(); ++channel)
    c.channels[channel].values = std::move(even[channel]);
  c.notes.push_back(fmt::format(
      "The record has {} sections with sampling rates from {:.6g} to {:.6g} samples/s; its waveforms were resampled "
      "uniformly at {:.7g} samples/s.",
      c.stretches.size(), low.rate, high.rate, rate));
  c.t = std::move(t);
  c.stretches = {{rate, 0, n}};
  return true;
}
}  // namespace

void make_even(Comtrade& c, double min_rate, Problems& problems) {
  const auto& all = c.stretches;
  if (all.size() < 2 || (min_rate > 0 && put_onto_mean_rate(c))) return;
  // Find the longest run of consecutive stretches that are fast enough.
  std::size_t from = 0, to = 0;
  double longest = -1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::size_t j = i;
    while (j < all.size() && all[j].rate >= min_rate) ++j;
    const double lasts = j > i ? c.t[all[j - 1].end - 1] - c.t[all[i].first] : -1;
    if (lasts > longest) longest = lasts, from = i, to = j;
  }
  if (to == from) return;  // no stretch is fast enough: the reader of waveforms reports this
  double low = all[from].rate;
  for (std::size_t i = from; i < to; ++i) low = std::min(low, all[i].rate);
  std::string rates;
  std::size_t anchor = all[from].first;
  for (std::size_t i = 0; i < all.size(); ++i) {
    rates += fmt::format("{}{:g}", i == 0 ? "" : ", ", all[i].rate);
    const double ratio = all[i].rate / low;
    if (i >= from && i < to && all[i].rate == low) anchor = all[i].first;
    if (i >= from && i < to && std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
      problems.add(fmt::format("incompatible sampling rates of {:g} and {:g} per second", all[i].rate, low),
                   c.file,
                   "the higher rate is not a multiple of the lower one, so no uniform sampling exists",
                   "export the record with a single rate");
  }
  std::vector<std::size_t> kept;
  for (std::size_t k = all[from].first; k < all[to - 1].end; ++k) {
    const double steps = (c.t[k] - c.t[anchor]) * low;
    if (std::abs(steps - std::round(steps)) < 1e-3) kept.push_back(k);
  }
  std::string note = fmt::format("The record has the sampling rates {} per second; ", rates);
  if (to - from < all.size())
    note += fmt::format(
        "the section from {:.4g} to {:.4g} s was used; the others are shorter or too slow for waveforms",
        c.t[kept.front()], c.t[kept.back()]);
  if (kept.size() < all[to - 1].end - all[from].first)
    note += fmt::format("{}faster sections were decimated to {:g} per second",
                        to - from < all.size() ? "; " : "", low);
  c.notes.push_back(note + ".");
  const auto pick = [&](auto& values) {
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
    values.resize(kept.size());
  };
  pick(c.t), pick(c.places);
  for (ComtradeChannel& channel : c.channels) pick(channel.values);
  c.stretches = {{low, 0, kept.size()}};
}

Comtrade parse_comtrade(std::string_view cfg, std::string_view dat, const std::string& cfg_name,
                        const std::string& dat_name) {
  Problems problems;
  ComtradeConfig config = parse_comtrade_config(cfg, cfg_name, problems);
  problems.raise();  // the data cannot be interpreted without a valid configuration
  Comtrade record = Data(std::move(config), dat, dat_name, problems).read();
  problems.raise();
  return record;
}

Comtrade parse_cff(std::string_view cff, const std::string& name) {
  std::string cfg_heading, dat_heading;
  const std::string_view cfg = section(cff, "CFG", cfg_heading), dat = section(cff, "DAT", dat_heading);
  if (cfg_heading.empty() || dat_heading.empty())
    throw InputError({"no section CFG or DAT", name,
                      "a .cff holds the sections '--- file type: CFG ---' and '--- file type: DAT'",
                      "export it again, or give .cfg and .dat"});
  return parse_comtrade(cfg, dat, name + " (CFG)", name + " (DAT)");
}

}  // namespace swingbank::validate::record
