#include "validate/record/comtrade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "validate/record/detail/build.hpp"
#include "validate/record/detail/comtrade_cfg.hpp"

namespace swingbank::validate::record {
namespace {

/// An integer or float of the file, little-endian as the standard has it.
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
    if (out_.kind == "ASCII")
      lines();
    else
      bytes();
    const auto found = static_cast<long>(out_.places.size());
    if (found > c_.samples && found <= c_.samples + 1 + c_.samples / 100)
      out_.notes.push_back(fmt::format("The data hold {} samples, the configuration says {}: all were read.",
                                       found, c_.samples));
    else if (found != c_.samples)
      problems_.add(fmt::format("{} samples", out_.places.size()), out_.file,
                    fmt::format("the configuration has {}", c_.samples), "export the record again");
    times();
    faults_.tell(problems_, out_.file);
    return std::move(out_);
  }

 private:
  void lines() {
    int number = 0;
    while (!dat_.empty()) {
      const auto fields = comtrade_fields(comtrade_line(dat_));
      ++number;
      if (fields.size() == 1 && fields[0].empty()) continue;
      const std::size_t sample = begin(static_cast<std::size_t>(number));
      const std::size_t wanted = 2 + out_.channels.size() + static_cast<std::size_t>(c_.status);
      if (fields.size() != wanted)
        faults_.add("fields", fmt::format("{} fields", fields.size()), sample,
                    fmt::format("the configuration means {}", wanted), "export the data again");
      const auto field = [&](std::size_t i) { return i < fields.size() ? fields[i] : std::string_view{}; };
      numbered(sample, comtrade_number(field(0)).value_or(-1));
      stamps_.push_back(comtrade_number(field(1)).value_or(kNoValue));
      for (std::size_t c = 0; c < out_.channels.size(); ++c)
        add(c, text_value(out_.channels[c], field(2 + c), sample));
    }
  }

  /// Missing: empty, or 99999 in 1999 (8.4).
  double text_value(const ComtradeChannel& channel, std::string_view text, std::size_t sample) {
    const auto v = comtrade_number(text);
    if (!v && !text.empty())
      faults_.add(channel.id, fmt::format("{} = '{}'", channel.id, text), sample, "this is no number",
                  "export the data again");
    return v && !(out_.revision == 1999 && *v == 99999) ? *v : kNoValue;
  }

  void bytes() {
    const std::size_t width = out_.kind == "BINARY" ? 2 : 4;
    const std::size_t size =
        8 + width * out_.channels.size() + 2 * ((static_cast<std::size_t>(c_.status) + 15) / 16);
    out_.sample_bytes = size;
    const std::size_t n = dat_.size() / size;
    if (dat_.size() % size != 0)
      problems_.add(fmt::format("{} bytes left over", dat_.size() % size),
                    fmt::format("{}, byte {}", out_.file, n * size),
                    fmt::format("a sample of this configuration takes {} bytes", size),
                    "check that .cfg and .dat belong together, and export them again");
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at = k * size;
      const std::size_t sample = begin(at);
      numbered(sample, little<std::uint32_t>(dat_, at));
      const auto stamp = little<std::uint32_t>(dat_, at + 4);
      stamps_.push_back(stamp == 0xFFFFFFFFU ? kNoValue : stamp);
      for (std::size_t c = 0; c < out_.channels.size(); ++c) add(c, binary_value(at + 8 + width * c));
    }
  }

  /// Missing: 0x8000 and 0x80000000 (8.6); a FLOAT32 that is not finite.
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

  /// Numbers count up by one; each break is told once.
  void numbered(std::size_t sample, double number) {
    if (sample > 0 && number != next_number_)
      faults_.add("number", fmt::format("sample number {:g}", number), sample,
                  fmt::format("{:g} was to come", next_number_),
                  "samples are missing or repeated: fill the gap at the source, or cut the record");
    next_number_ = number + 1;
  }

  void add(std::size_t channel, double x) {
    ComtradeChannel& c = out_.channels[channel];
    const double ratio = c.secondary_values ? c.primary / c.secondary : 1.0;
    c.values.push_back((c.a * x + c.b) * ratio);
  }

  void times() {
    const std::size_t n = out_.places.size();
    out_.t.resize(n);
    if (c_.rate > 0) {
      for (std::size_t k = 0; k < n; ++k) out_.t[k] = static_cast<double>(k) / c_.rate;
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

  /// The rate counts (8.3), but a reader should know where the stamps say something else.
  void compare_stamps() {
    if (stamps_.size() < 2) return;
    const double stamped = (stamps_.back() - stamps_.front()) * c_.stamp, rated = out_.t.back();
    if (std::isfinite(stamped) && stamped > 0 && std::abs(stamped - rated) > 0.01 * rated)
      out_.notes.push_back(fmt::format(
          "The time stamps of the data span {:.6g} s, the sampling rate of the configuration {:.6g} s; the "
          "rate was taken.",
          stamped, rated));
  }

  ComtradeConfig c_;
  Comtrade out_;
  std::string_view dat_;
  Problems& problems_;
  SampleFaults faults_;
  std::vector<double> stamps_;
  double next_number_ = 1;
};

/// The section of a .cff whose heading holds `word`; `heading` becomes that line.
std::string_view section(std::string_view cff, std::string_view word, std::string& heading) {
  constexpr std::string_view mark = "--- file type:";
  for (auto at = cff.find(mark); at != std::string_view::npos; at = cff.find(mark, at + 1)) {
    std::string_view rest = cff.substr(at);
    heading = comtrade_line(rest);
    if (heading.find(word) == std::string::npos) continue;
    if (heading.find("BINARY") == std::string::npos && heading.find("FLOAT") == std::string::npos)
      return rest.substr(0, rest.find(mark));
    // "DAT BINARY: 1234 ---": so many bytes.
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

Comtrade parse_comtrade(std::string_view cfg, std::string_view dat, const std::string& cfg_name,
                        const std::string& dat_name) {
  Problems problems;
  ComtradeConfig config = parse_comtrade_config(cfg, cfg_name, problems);
  problems.raise();  // without it the data mean nothing
  Comtrade record = Data(std::move(config), dat, dat_name, problems).read();
  problems.raise();
  return record;
}

Comtrade parse_cff(std::string_view cff, const std::string& name) {
  std::string cfg_heading, dat_heading;
  const std::string_view cfg = section(cff, "CFG", cfg_heading), dat = section(cff, "DAT", dat_heading);
  if (cfg_heading.empty() || dat_heading.empty())
    throw InputError({"no record", name,
                      "a .cff holds the sections '--- file type: CFG ---' and '--- file type: DAT'",
                      "export it again, or give .cfg and .dat"});
  return parse_comtrade(cfg, dat, name + " (CFG)", name + " (DAT)");
}

}  // namespace swingbank::validate::record
