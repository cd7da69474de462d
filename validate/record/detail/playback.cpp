#include "validate/record/detail/playback.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/capitals.hpp"
#include "base/median.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/detail/text.hpp"
#include "validate/record/detail/times.hpp"

namespace swingbank::validate::record {
namespace {

using Words = std::vector<std::string_view>;

/// Splits a line at blanks, commas and tabs; quoted text is one word.
Words words_of(std::string_view line) {
  Words words;
  constexpr std::string_view between = " ,\t\r";
  for (std::size_t at = 0; (at = line.find_first_not_of(between, at)) != std::string_view::npos;) {
    const bool quoted = line[at] == '"';
    const std::size_t begin = quoted ? at + 1 : at;
    const std::size_t end =
        std::min(quoted ? line.find('"', begin) : line.find_first_of(between, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    at = std::min(end + (quoted ? 1 : 0), line.size());
  }
  return words;
}

std::optional<double> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double v = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
  const bool ok = error == std::errc{} && end == word.data() + word.size() && std::isfinite(v);
  return ok ? std::optional(v) : std::nullopt;
}

class Playback {
 public:
  Playback(std::string_view text, std::string name, const RecordBase& base)
      : text_(text), name_(std::move(name)), base_(base) {}

  Record read(const ReadOptions& options) {
    if (is_powerworld(text_)) find_block();
    rows();
    RawRecord raw;
    raw.about.name = name_;
    raw.about.format = powerworld_ ? "PowerWorld play-in" : "PSS/E playback";
    raw.uneven = true;
    raw.columns = {{"time", {Quantity::time, Unit::second, false, {}, false}, std::move(t_)}};
    if (v_.empty()) problems_.add("empty record", name_, "there is no line of numbers", "export it again");
    problems_.raise();
    add_voltage(raw);
    if (!f_.empty()) add_frequency(raw);
    if (options.power && !options.part)
      problems_.add("no column of P and Q", name_,
                    "a playback file contains the played-in signals, not the measured response",
                    "join it with a file of the measured P and Q: " + name_ + "+FILE");
    problems_.raise();
    SampleFaults faults([this](std::size_t a, std::size_t b) {
      return a == b ? fmt::format("{}:{}", name_, lines_[a])
                    : fmt::format("{}:{}-{}", name_, lines_[a], lines_[b]);
    });
    return build_record(std::move(raw), base_, options, std::move(faults), std::move(problems_), name_);
  }

 private:
  /// Locates the values between braces and the fields of time, voltage and frequency.
  void find_block() {
    powerworld_ = true;
    const auto open = text_.find('['), close = text_.find(']', open), brace = text_.find('{', close);
    const auto end = text_.find('}', brace);
    if (brace == std::string_view::npos || end == std::string_view::npos) {
      problems_.add("play-in signals without values", name_, "fields are enclosed in [ ], values in { }",
                    "export it again");
      problems_.raise();
    }
    line_ += static_cast<int>(std::ranges::count(text_.substr(0, brace), '\n'));
    const Words fields = words_of(text_.substr(open + 1, close - open - 1));
    time_ = voltage_ = frequency_ = fields.size();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::string field = capitals(fields[i]);
      if (field == "TSTIME" || field == "TSTIMEINSECONDS" || field == "DSTIMEINSECONDS") time_ = i;
      if (field == "TSSIGNAL" || field == "TSSIGNAL:0" || field == "SIGNAL") voltage_ = i;
      if (field == "TSSIGNAL:1" || field == "SIGNAL:1") frequency_ = i;
    }
    if (time_ == fields.size() || voltage_ == fields.size())
      problems_.add("play-in signals without time or voltage", name_,
                    fmt::format("the fields are {}", fmt::join(fields, ", ")),
                    "give TSTime, TSSignal (voltage) and TSSignal:1 (frequency)");
    problems_.raise();
    text_ = text_.substr(brace + 1, end - brace - 1);
  }

  void rows() {
    while (!text_.empty()) {
      const Words words = words_of(take_line(text_));
      ++line_;
      if (words.empty() || words[0].starts_with("//") || words[0].starts_with('#') ||
          words[0].starts_with('!'))
        continue;
      row(words);
    }
  }

  void row(const Words& words) {
    const auto at = [&](std::size_t i) { return i < words.size() ? number(words[i]) : std::nullopt; };
    const auto t = at(time_), v = at(voltage_), f = at(frequency_);
    if (!t && t_.empty() && !powerworld_) return;  // a title
    if (!t || !v || (!f_.empty() && !f)) {
      problems_.add("a line that is not a sample", fmt::format("{}:{}", name_, line_),
                    "it must hold time, voltage and frequency as numbers", "correct the line or remove it");
      return;
    }
    lines_.push_back(line_);
    t_.push_back(*t);
    v_.push_back(*v);
    if (f) f_.push_back(*f);
  }

  void add_voltage(RawRecord& raw) {
    const double v = upper_median(v_);
    std::optional<Unit> unit;
    if (v > 0.3 && v < 1.7)
      unit = Unit::pu;
    else if (base_.kv > 0 && std::abs(v / base_.kv - 1) < 0.4)
      unit = Unit::kilovolt;
    else if (base_.kv > 0 && std::abs(v / base_.kv / 1e3 - 1) < 0.4)
      unit = Unit::volt;
    if (!unit)
      problems_.add(fmt::format("voltages of about {:.4g}", v), name_,
                    "the voltages are neither near 1 pu nor near base_kv",
                    "set base_kv (line to line) under [record] in the plant file");
    raw.about.notes.push_back(
        fmt::format("The file names no units; the voltage, about {:.4g}, was taken to be in {}.", v,
                    !unit || *unit == Unit::pu ? "pu"
                    : *unit == Unit::kilovolt  ? "kV"
                                               : "V"));
    raw.columns.push_back({"voltage", {Quantity::V, unit, false, {}, false}, std::move(v_)});
  }

  void add_frequency(RawRecord& raw) {
    const double f = upper_median(f_);
    std::optional<Unit> unit;
    if (std::abs(f - 1) < 0.1 || std::abs(f) < 0.05) unit = Unit::pu;
    if (std::abs(f / base_.frequency - 1) < 0.25) unit = Unit::hertz;
    const bool deviation = std::abs(f) < 0.05;
    if (!unit)
      problems_.add(fmt::format("frequencies of about {:.4g}", f), name_,
                    fmt::format("the frequencies are neither in pu nor near {:g} Hz", base_.frequency),
                    "check the column and frequency_hz in the plant file");
    raw.about.notes.push_back(fmt::format("The frequency, about {:.4g}, was taken to be {}.", f,
                                          deviation             ? "a deviation in pu"
                                          : unit == Unit::hertz ? "in Hz"
                                                                : "in pu"));
    raw.columns.push_back({"frequency", {Quantity::f, unit, deviation, {}, false}, std::move(f_)});
  }

  std::string_view text_;
  std::string name_;
  RecordBase base_;
  Problems problems_;
  bool powerworld_ = false;
  std::size_t time_ = 0, voltage_ = 1, frequency_ = 2;
  std::vector<double> t_, v_, f_;
  std::vector<int> lines_;
  int line_ = 0;
};

}  // namespace

bool is_plb(const std::string& name) { return capitals(name).ends_with(".PLB"); }

bool is_powerworld(std::string_view text) {
  const std::string head = capitals(text.substr(0, 4096));
  const auto data = head.find("DATA");
  return data != std::string::npos && head.find("PLAYINSIGNAL", data) != std::string::npos;
}

Record playback_record(std::string_view text, const std::string& name, const RecordBase& base,
                       const ReadOptions& options) {
  return Playback(text, name, base).read(options);
}

}  // namespace swingbank::validate::record
