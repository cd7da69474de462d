#include "validate/noise/event_fit.hpp"

namespace swingbank::validate::noise {

std::vector<event::EventState> states_of(const std::vector<EventFit>& events) {
  std::vector<event::EventState> states;
  for (const EventFit& e : events) states.push_back(e.state);
  return states;
}

void compare(const WhitenedEvents& events, std::size_t which, const playin::Response& response, EventFit& f) {
  const event::FitEvent& event = events[which];
  f.model.clear();
  for (const playin::Output o : event.channels) f.model.push_back(response.of(o));
  RowMatrix e = event.collected(response.value, true);
  events.noise(which).whiten(e);
  f.noise = events.noise_model();
  f.values = event.values();
  f.chi2 = e.squaredNorm();
  f.residual.assign(event.channels.size(), std::vector<double>(event.record.t.size(), 0.0));
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < event.record.t.size(); ++k)
    for (std::size_t c = 0; event.compared(k) && c < event.channels.size(); ++c)
      f.residual[c][k] = e(row++, 0);
}

}  // namespace swingbank::validate::noise
