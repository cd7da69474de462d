#pragma once
// Recorded inputs of a component other than the voltage, as functions of time.
#include <optional>
#include <vector>

#include "validate/playin/plant_playback.hpp"

namespace swingbank::validate::playin {

/// Splines through the samples of each segment, as for the voltage. Signals that the record lacks keep their
/// initial values.
class Given {
 public:
  /// Constructs the splines through all samples of the record `played`.
  Given(const record::Record& played, const std::vector<Switching>& switchings, const OperatingPoint& start);

  /// Signals at t [s], powers and Pref on the record's base: deviations from the initial values, except for P
  /// and Q.
  struct At {
    double P = 0, Q = 0, speed = 0, Ifd = 0, Vs = 0, Vref = 0, Efd = 0, Pm = 0, Pref = 0;  ///< [pu]
  };
  /// Returns the signals at t [s] in a segment of the voltage curve.
  [[nodiscard]] At operator()(int segment, double t) const;
  /// Returns the steady-state values before the event.
  static At steady_values(const OperatingPoint& start);

 private:
  struct Pair {
    double At::*first;
    double At::*second;
    VoltageCurve curve;
  };
  std::vector<Pair> pairs_;
  At before_;
};

/// Returns whether the record is of an exciter or a governor, which is simulated with the recorded machine.
inline bool is_part(const record::Record& r) {
  return r.component == record::Component::exciter || r.component == record::Component::governor;
}
/// Sets every input and every compared channel of a component to its initial value.
void set_to_initial(record::Record& record, const OperatingPoint& start);
/// Returns the inputs of the record's component; empty if the record is of a whole plant.
std::optional<Given> given_of(const record::Record& record, const std::vector<Switching>& switchings,
                              const OperatingPoint& start);

}  // namespace swingbank::validate::playin
