// Repeated playback of a compared event with other parameter values.
#include <algorithm>
#include <utility>

#include "validate/compare/compare.hpp"
#include "validate/compare/detail/standard_deviation.hpp"
#include "validate/playin/given.hpp"

namespace swingbank::validate::compare {
namespace {

const std::vector<double>& output(const playin::Playback& p, const std::string& channel) {
  for (int o = 0; o < playin::kOutputs; ++o)
    if (const auto output = static_cast<playin::Output>(o); playin::output_name(output) == channel)
      return playin::output_of(p, output);
  static const std::vector<double> kNone;
  return kNone;
}

playin::Playback played(const sim::plant::PlantUnderTest& tested, const EventComparison& e) {
  if (!e.playback.P.empty() || playin::is_part(e.record) || e.record.breaker()) {
    playin::Response r = event::play(tested, *e.prepared, e.state);
    playin::Playback back;
    playin::take_outputs(r, back);
    return back;
  }
  return playin::play_in_power(tested, e.record, e.switchings);
}

}  // namespace

std::vector<ReplayedChannel> replay(const sim::plant::PlantUnderTest& tested, const EventComparison& e) {
  const playin::Playback back = played(tested, e);
  std::vector<ReplayedChannel> all;
  for (const ChannelComparison& c : e.channels) {
    ReplayedChannel r;
    r.modelled = c.name == "frequency" ? frequency_of(e.record.t, back.theta, e.record.base.frequency)
                                       : output(back, c.name);
    if (r.modelled.size() == c.measured.size()) {
      std::vector<double> residual(c.measured.size());
      std::ranges::transform(r.modelled, c.measured, residual.begin(), std::minus<>());
      r.noise = standard_deviation(residual, e.playback.start.samples);
      r.whole = window_error(e.record.t, residual, e.left_out,
                             {"whole record", e.record.t.front(), e.record.t.back()}, true, r.noise);
    }
    all.push_back(std::move(r));
  }
  return all;
}

}  // namespace swingbank::validate::compare
