// COMTRADE files written from the standard's layout (C37.111-1991, -1999 and -2013, 7 and 8), and their
// content.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {

inline constexpr double kPi = std::numbers::pi, kTurn = 2 * kPi;

struct Channel {
  std::string id, phase, component, unit;
  double a = 0.001, b = 0;
  std::function<double(double)> value;  ///< value at a time [s]; at a step, on the side given by `side`
  double skew_us = 0, primary = 1, secondary = 1;
  char side = 'P';
};

/// Writes a pair of files. `edit` may modify the lines of the configuration.
struct Writer {
  int revision = 1999;
  std::string kind = "ASCII";
  double rate = 60, nominal = 60;
  int samples = 90, status = 0;
  bool stamps_only = false, nanoseconds = false;
  double multiplier = 1, first_stamp = 0;
  std::vector<Channel> channels;
  std::function<void(std::vector<std::string>& cfg)> edit = [](auto&) {};
  int missing = -1;                                ///< sample whose first channel is marked missing
  std::vector<std::pair<double, int>> rates = {};  ///< several rates, each with its last sample

  /// Time of sample k [s].
  [[nodiscard]] double time(int k) const {
    if (rates.empty()) return k / rate;
    double t = -1 / rates[0].first;
    int first = 0;
    for (const auto& [r, last] : rates) {
      t += std::max(0, std::min(k + 1, last) - first) / r;
      first = last;
    }
    return t;
  }

  [[nodiscard]] std::string cfg() const {
    std::vector<std::string> lines{
        revision == 1991 ? "station,device" : fmt::format("station,device,{}", revision),
        fmt::format("{},{}A,{}D", channels.size() + static_cast<std::size_t>(status), channels.size(),
                    status)};
    int n = 0;
    for (const auto& c : channels)
      lines.push_back(fmt::format("{},{},{},{},{},{},{},{},-32767,32767", ++n, c.id, c.phase, c.component,
                                  c.unit, c.a, c.b, c.skew_us) +
                      (revision == 1991 ? "" : fmt::format(",{},{},{}", c.primary, c.secondary, c.side)));
    for (int d = 0; d < status; ++d) lines.push_back(fmt::format("{},trip,,,0", d + 1));
    lines.push_back(fmt::format("{}", nominal));
    lines.push_back(stamps_only ? "0" : fmt::format("{}", std::max<std::size_t>(1, rates.size())));
    for (const auto& [r, last] : rates) lines.push_back(fmt::format("{},{}", r, last));
    if (rates.empty()) lines.push_back(fmt::format("{},{}", stamps_only ? 0 : rate, samples));
    const char* const fraction = nanoseconds ? "250000000" : "250000";
    const char* const date = revision == 1991 ? "05/01/24" : "01/05/2024";
    lines.push_back(fmt::format("{},12:00:00.{}", date, fraction));
    lines.push_back(fmt::format("{},12:00:01.{}", date, fraction));
    lines.push_back(kind);
    if (revision != 1991) lines.push_back(fmt::format("{}", multiplier));
    if (revision == 2013) lines.insert(lines.end(), {"0,0", "0,3"});
    edit(lines);
    std::string all;
    for (const auto& l : lines) all += l + "\r\n";
    return all;
  }

  [[nodiscard]] std::string dat() const {
    std::string all;
    const auto put = [&](auto value) {
      char bytes[sizeof value];
      std::memcpy(bytes, &value, sizeof value);  // the host is little-endian, as is the format
      all.append(bytes, sizeof value);
    };
    for (int k = 0; k < samples; ++k) {
      const double t = time(k);
      const auto stamp =
          static_cast<std::uint32_t>(std::llround(first_stamp + t * (nanoseconds ? 1e9 : 1e6) / multiplier));
      if (kind == "ASCII")
        all += fmt::format("{},{}", k + 1, stamp);
      else
        put(static_cast<std::uint32_t>(k + 1)), put(stamp);
      for (const auto& c : channels) {
        const bool lost = k == missing && &c == channels.data();
        const double x = (c.value(t + 1e-6 * c.skew_us) - c.b) / c.a;
        if (kind == "ASCII")
          all += lost ? std::string(revision < 2013 ? ",99999" : ",") : fmt::format(",{:.0f}", x);
        else if (kind == "BINARY")
          put(lost ? std::int16_t{-32768} : static_cast<std::int16_t>(std::lround(x)));
        else if (kind == "BINARY32")
          put(lost ? std::numeric_limits<std::int32_t>::min() : static_cast<std::int32_t>(std::lround(x)));
        else
          put(lost ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(x));
      }
      if (kind == "ASCII") {
        for (int d = 0; d < status; ++d) all += ",1";
        all += "\r\n";
      } else {
        for (int d = 0; d < (status + 15) / 16; ++d) put(std::uint16_t{1});
      }
    }
    return all;
  }
  Record read(const RecordBase& base = kTestBase, const ReadOptions& options = {}) const {
    return record_of_comtrade(parse_comtrade(cfg(), dat(), "e.cfg", "e.dat"), "e.cfg", base, options);
  }
  [[nodiscard]] std::vector<std::string> faults(const RecordBase& base = kTestBase,
                                                const ReadOptions& options = {}) const {
    return test::messages([&] { read(base, options); });
  }
};

/// 1.02 pu, 10 degrees, 80 MW, 20 Mvar, slowly moving.
inline double slow(double t) { return 0.05 * std::sin(kTurn * 0.5 * t); }
inline Writer phasors(int revision = 1999, const std::string& kind = "ASCII") {
  Writer w;
  w.revision = revision;
  w.kind = kind;
  w.channels = {{"V1 MAG", "", "G7", "kV", 0.01, 0, [](double t) { return 138 * (1.02 + slow(t)); }},
                {"V1 ANG", "", "G7", "deg", 0.01, 0, [](double t) { return 10 + 100 * slow(t); }},
                {"P", "", "G7", "MW", 0.01, 0.5, [](double t) { return 80 + 100 * slow(t); }},
                {"Q", "", "G7", "MVAR", 0.01, 0, [](double t) { return 20 - 100 * slow(t); }},
                {"SPARE", "", "G7", "V", 0.01, 0, [](double) { return 0.0; }}};
  return w;
}

/// Waveforms of slowly moving phasors, with the sign of a generator's current.
struct Machine {
  double hertz_off = 0, harmonic = 0, negative = 0, scale = 1;
  [[nodiscard]] double V(double t) const { return scale * (1.02 + slow(t)); }
  [[nodiscard]] double theta(double t) const { return 0.3 + kTurn * hertz_off * t + slow(t); }
  [[nodiscard]] Complex current(double t) const {  // pu on 200 MVA
    return std::conj(Complex(0.4 + slow(t), 0.1) / std::polar(V(t), theta(t)));
  }
  /// Waveform of phase p, `peak` at 1 pu.
  [[nodiscard]] double wave(Complex x, double t, int p, double peak) const {
    const double w = kTurn * 60 * t, shift = -kTurn / 3 * p;
    const double base = std::abs(x) * std::cos(w + std::arg(x) + shift);
    return peak * (base + negative * std::cos(w - shift) + harmonic * std::cos(5 * (w + shift)));
  }
};
inline Writer waveforms(const Machine& m, double rate = 4800, int samples = 4800) {
  Writer w;
  w.rate = rate;
  w.samples = samples;
  w.revision = 2013;
  w.kind = "FLOAT32";
  const double volts = 138 * std::sqrt(2.0 / 3),
               amperes = 1e3 * 200 / (std::sqrt(3.0) * 138) * std::sqrt(2.0);
  for (int p = 0; p < 3; ++p) {
    const std::string phase(1, static_cast<char>('A' + p));
    w.channels.push_back({"V" + phase, phase, "G7", "kV", 1, 0,
                          [=](double t) { return m.wave(std::polar(m.V(t), m.theta(t)), t, p, volts); }});
    w.channels.push_back(
        {"I" + phase, phase, "G7", "A", 1, 0, [=](double t) { return m.wave(m.current(t), t, p, amperes); }});
  }
  return w;
}
/// Largest error of V, theta, P and Q against the machine at the record's own times.
inline double largest_error(const Record& r, const Machine& m) {
  double worst = 0;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const double t = r.t[k];
    const double turns = std::remainder(r.theta[k] - m.theta(t), kTurn);
    worst = std::max({worst, std::abs(r.V[k] - m.V(t)), std::abs(turns), std::abs(r.P[k] - 0.4 - slow(t)),
                      std::abs(r.Q[k] - 0.1)});
  }
  return worst;
}

}  // namespace swingbank::validate::record
