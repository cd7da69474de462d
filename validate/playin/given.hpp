#pragma once
// What beside the voltage drives a component: recorded signals as functions of time.
#include <optional>
#include <vector>

#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::playin {

/// Splines through the samples of each segment, as the voltage's. Signals that a record lacks stay where they
/// were at the start.
class Given {
 public:
  /// `played`: the record without samples that are not played in.
  Given(const record::Record& played, const std::vector<Switching>& switchings, const OperatingPoint& start);

  /// Signals at t [s], on the record's base; but for P and Q deviations from the start.
  struct At {
    double P = 0, Q = 0, speed = 0, Ifd = 0, Vs = 0, Vref = 0, Efd = 0, Pm = 0, Pref = 0;
  };
  [[nodiscard]] At operator()(int segment, double t) const;
  /// What stands before anything moves.
  static At standing(const OperatingPoint& start);

 private:
  struct Pair {
    double At::*first;
    double At::*second;
    VoltageCurve curve;
  };
  std::vector<Pair> pairs_;
  At before_;
};

/// Whether the record is of a part that stands beside the recorded machine.
inline bool is_part(const record::Record& r) {
  return r.component == record::Component::exciter || r.component == record::Component::governor;
}
/// The instants of a record whose breaker opens: the jump that was found within kNearBreaker of the time that
/// is given, or where P falls by half, else that time.
std::vector<Switching> breaker_instants(const record::Record& record, const std::vector<Switching>& found);
constexpr double kNearBreaker = 0.2;  ///< [s]
/// Makes every channel that drives a component or is compared stand where it was at the start.
void stand_still(record::Record& record, const OperatingPoint& start);
/// What drives the record's component; nothing where the whole plant is tried.
std::optional<Given> given_of(const record::Record& record, const std::vector<Switching>& switchings,
                              const OperatingPoint& start);

}  // namespace swingbank::validate::playin
