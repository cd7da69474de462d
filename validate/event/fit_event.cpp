#include "validate/event/fit_event.hpp"

#include "validate/playin/component.hpp"
#include "validate/playin/given.hpp"

namespace swingbank::validate::event {

const std::vector<double>& FitEvent::measured(playin::Output o) const { return playin::output_of(record, o); }

bool FitEvent::turns() const {
  return record.angle == record::AngleSource::integrated && !playin::is_part(record) && !record.breaker();
}

void FitEvent::keep_curve() {
  kept = {};
  const record::Record& r = played();
  if (r.t.empty() || r.V.size() != r.t.size() || r.theta.size() != r.t.size()) return;
  try {
    kept = KeptCurve(std::make_unique<const playin::VoltageCurve>(r, switchings));
  } catch (const InputError&) {
  }
}

playin::VoltageCurve FitEvent::curve(std::vector<switching::Switching> at) const {
  return kept.get() ? kept.get()->moved(played(), std::move(at))
                    : playin::VoltageCurve(played(), std::move(at));
}

Eigen::VectorXd FitEvent::collected(const std::vector<double>* values, bool less_measured) const {
  Eigen::VectorXd all(this->values());
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    if (!compared(k)) continue;
    for (const playin::Output o : channels)
      all[row++] = values[static_cast<int>(o)][k] - (less_measured ? measured(o)[k] : 0.0);
  }
  return all;
}

}  // namespace swingbank::validate::event
