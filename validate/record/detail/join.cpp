// Joins the files of one event.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "validate/record/detail/build.hpp"

namespace swingbank::validate::record {
namespace {

/// Refers the times of `from` to t = 0 of `all`, if both files state when they begin. Adds a problem if they
/// state different clock times of unknown time zones.
void align_clocks(Record& from, Record& all, const std::string& files, Problems& problems) {
  if (all.start.empty() || from.start.empty() || all.start == from.start) return;
  if (all.epoch && from.epoch) {
    const double later = *from.epoch - *all.epoch;
    for (double& t : from.t) t += later;
    from.epoch = all.epoch;
    return;
  }
  problems.add("files that begin at different times", files,
               fmt::format("t = 0 is {} in one file and {} in another, and their time zones are not known",
                           all.start, from.start),
               "name the time columns UTC, or give times in seconds from one zero");
}

/// Copies the channels of `from` to the record `all`, with linear interpolation if their times differ.
void take_over(Record& from, Record& all, const std::string& files, Problems& problems) {
  align_clocks(from, all, files, problems);
  const double slack = 1e-3 * all.step();
  const double first = std::max(all.t.front(), from.t.front()), last = std::min(all.t.back(), from.t.back());
  if (!(last - first > all.step() * kMinSamples)) {
    problems.add("files that do not overlap", files,
                 fmt::format("one file covers t = {:.6g} to {:.6g} s, another {:.6g} to {:.6g} s",
                             all.t.front(), all.t.back(), from.t.front(), from.t.back()),
                 "give files of one event, with one clock");
    return;
  }
  if (all.t.front() < first - slack || all.t.back() > last + slack) {
    all = stretch(std::move(all), first - slack, last + slack);
    all.notes.push_back(
        fmt::format("Only the time range common to all files is used: {:.6g} to {:.6g} s.", first, last));
  }
  bool same = true;
  std::vector<double> places;
  for (const double t : all.t) {
    const double place =
        std::clamp((t - from.t.front()) / from.step(), 0.0, static_cast<double>(from.t.size() - 1));
    const bool meets = std::abs(place - std::round(place)) < 1e-3;
    same = same && meets;
    places.push_back(meets ? std::round(place) : place);
  }
  if (!same)
    all.notes.push_back(fmt::format(
        "{}, sampled {:.6g} times a second, was interpolated linearly to the sampling times of {}.",
        from.name, from.rate(), all.name));
  for (const auto q :
       {Quantity::V, Quantity::theta, Quantity::f, Quantity::P, Quantity::Q, Quantity::speed, Quantity::Efd,
        Quantity::Ifd, Quantity::Vs, Quantity::Vref, Quantity::Pm, Quantity::Pref, Quantity::gate}) {
    std::vector<double>& values = *channel(from, q);
    if (values.empty()) continue;
    if (!channel(all, q)->empty())
      problems.add("two columns of " + std::string(word_of(q)), files, "several files contain it",
                   "name one of them: --columns");
    *channel(all, q) = at_places(values, places);
  }
  for (std::size_t k = 0; k < places.size() && !from.lost.empty(); ++k)
    if (from.lost[static_cast<std::size_t>(places[k])] ||
        from.lost[static_cast<std::size_t>(std::ceil(places[k]))]) {
      all.lost.resize(all.t.size(), 0);
      all.lost[k] = 1;
    }
  if (!all.epoch && from.epoch && from.t.front() == 0) all.epoch = from.epoch;
  if (all.start.empty()) all.start = from.start;
  std::ranges::move(from.notes, std::back_inserter(all.notes));
  std::ranges::move(from.named, std::back_inserter(all.named));
  std::ranges::move(from.ignored, std::back_inserter(all.ignored));
}

}  // namespace

Record join_records(std::vector<Record> parts, const ReadOptions& options, const std::string& files) {
  Problems problems;
  const auto with_power = std::ranges::find_if(parts, [](const Record& r) { return !r.P.empty(); });
  Record all = with_power == parts.end() ? parts.back() : *with_power;
  const auto first =
      static_cast<std::size_t>(with_power == parts.end() ? parts.size() - 1 : with_power - parts.begin());
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (i != first) take_over(parts[i], all, files, problems);
  for (const auto& [word, column] : options.columns)
    if (std::ranges::find(all.named, word) == all.named.end())
      problems.add(
          fmt::format("no column '{}'", column), files,
          "--columns or [record.columns] assigns it to " + word + ", but none of the files contains it",
          "name an existing column");
  const auto needs = [&](const std::vector<double>& channel, const char* what) {
    if (channel.empty())
      problems.add(fmt::format("no column of {}", what), files, "none of the files contains it",
                   "add a file that contains it, or assign a column with --columns");
  };
  if (options.component == Component::plant) {
    needs(all.V, "V");
    if (options.power) needs(all.P, "P"), needs(all.Q, "Q");
  }
  for (const auto& words : options.needed)
    if (std::ranges::none_of(words, [&](const std::string& word) {
          const auto m = quantity_of(word);
          const auto* values = m ? channel(all, m->quantity) : nullptr;
          return values && !values->empty();
        }))
      needs({}, words.front().c_str());
  problems.raise();
  settle_angle(all, options);
  if (all.component == Component::governor && all.V.empty()) all.V.assign(all.t.size(), 1.0);
  return stretch(std::move(all), options.from, options.until);
}

}  // namespace swingbank::validate::record
