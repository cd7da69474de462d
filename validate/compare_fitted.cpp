#include "validate/compare_fitted.hpp"

#include "validate/fit.hpp"
#include "validate/instruments.hpp"
#include "validate/voltage_doubt.hpp"

namespace swingbank::validate {

void play_fitted(const PlantModel& model, const CompareOptions& options, Jumps jumps, EventComparison& e) {
  const auto events = prepare_events(
      model, {e.record},
      {.jump_threshold = options.jump_threshold, .pre_event = options.play_in.pre_event, .jumps = jumps});
  const FitEvent& event = events.front();
  const Fit f = fit(model.plant, model.conventions, events, {});
  if (!f.failed.empty())
    throw InputError({"the model cannot follow the record", e.record.name, f.failed,
                      "check the model's parameters and the record's base and units"});
  const EventState& state = f.events.front().state;
  const VoltageCurve curve(event.played(), switchings_at(event, state));
  Drive run = drive_at(model.plant, model.conventions, event, state);
  run.curve = &curve;
  Response r = observe(run);
  const auto take = [&](Output o) { return std::move(r.value[static_cast<int>(o)]); };
  e.playback = Playback{};
  e.playback.start = run.start;
  e.playback.steps = r.steps;
  e.playback.P = take(Output::P);
  e.playback.Q = take(Output::Q);
  e.playback.speed = take(Output::speed);
  e.playback.Efd = take(Output::Efd);
  e.playback.Ifd = take(Output::Ifd);
  e.switchings = curve.switchings();
  e.fitted = !e.switchings.empty();
  if (jumps == Jumps::spread) e.left_out = event.left_out;
}

void add_doubt(const PlantModel& model, EventComparison& e) {
  FitEvent event;
  event.record = e.record;
  event.start = e.playback.start;
  event.smeared = e.left_out;  // those beside a jump too
  for (const Switching& s : e.switchings)
    if (s.uncertainty > 0) event.switchings.push_back(s);
  for (const Output o : {Output::P, Output::Q, Output::speed, Output::Efd, Output::Ifd})
    if (!event.measured(o).empty()) event.channels.push_back(o);
  const auto n = static_cast<Eigen::Index>(event.channels.size());
  event.noise = Eigen::VectorXd::Ones(n);  // what the channels' own noise is stands in the map
  event.whitening = Eigen::MatrixXd::Identity(n, n);
  e.doubt.clear();
  for (const auto& shape : voltage_doubt(model.plant, model.conventions, event).shapes)
    for (std::size_t c = 0; c < event.channels.size(); ++c)
      e.doubt[std::string(output_name(event.channels[c]))].push_back(shape[c]);
}

}  // namespace swingbank::validate
