#pragma once
// Controls implemented from the model sheets: SEXS and TGOV1 from ENTSO-E, Documentation on Controller Tests
// in Test Grid Configurations (2013); IEEEST from the PSS/E sheet, as PssIEEEST in IEC 61970-302. All use
// plain doubles; a limited state stops at its limit.
#include <algorithm>
#include <cmath>

namespace swingbank::blind_second {

/// Rate of a state with limits: zero at a limit if the rate points outwards.
inline double limited_rate(double rate, double x, double low, double high) {
  if (x >= high && rate > 0) return 0.0;
  if (x <= low && rate < 0) return 0.0;
  return rate;
}

struct Sexs {
  double ratio = 0.1, TB = 10, K = 100, TE = 0.05, low = -4, high = 5;
  double reference = 0;
  struct State {
    double lag = 0, Efd = 0;
  };
  State rest(double Efd, double V) {
    reference = V + Efd / K;
    return {Efd / K, Efd};
  }
  [[nodiscard]] double output(const State& x) const { return std::clamp(x.Efd, low, high); }
  [[nodiscard]] State rates(const State& x, double V, double Vs) const {
    const double error = reference - V + Vs;
    const double lead = x.lag + ratio * (error - x.lag);  // (1 + s TA)/(1 + s TB)
    return {(error - x.lag) / TB, limited_rate((K * lead - x.Efd) / TE, x.Efd, low, high)};
  }
};

struct Tgov1 {
  double R = 0.05, T1 = 0.5, high = 1.2, low = 0, T2 = 2, T3 = 7, Dt = 0;
  double reference = 0;
  struct State {
    double valve = 0, reheat = 0;
  };
  State rest(double Pm) {
    reference = Pm * R;
    return {Pm, Pm};
  }
  [[nodiscard]] double output(const State& x, double w) const {
    const double valve = std::clamp(x.valve, low, high);
    return x.reheat + T2 / T3 * (valve - x.reheat) - Dt * w;  // (1 + s T2)/(1 + s T3)
  }
  [[nodiscard]] State rates(const State& x, double w) const {
    const double valve = std::clamp(x.valve, low, high);
    return {limited_rate(((reference - w) / R - x.valve) / T1, x.valve, low, high), (valve - x.reheat) / T3};
  }
};

/// IEEEST with speed input, filter without numerator (A5 = A6 = 0), and no voltage cut-off.
struct Ieeest {
  double A1 = 0.06, A2 = 0.0016, A3 = 0.03, A4 = 0.0004;
  double T1 = 0.1, T2 = 0.02, T3 = 0.1, T4 = 0.02, T5 = 5, T6 = 5, KS = 10, high = 0.1, low = -0.1;
  struct State {
    double a = 0, da = 0, b = 0, db = 0, lag1 = 0, lag2 = 0, wash = 0;
  };
  [[nodiscard]] double output(const State& x) const {
    const double lead1 = x.lag1 + T1 / T2 * (x.b - x.lag1), lead2 = x.lag2 + T3 / T4 * (lead1 - x.lag2);
    return std::clamp(KS * T5 / T6 * (lead2 - x.wash), low, high);
  }
  [[nodiscard]] State rates(const State& x, double w) const {
    const double lead1 = x.lag1 + T1 / T2 * (x.b - x.lag1), lead2 = x.lag2 + T3 / T4 * (lead1 - x.lag2);
    return {x.da,
            (w - x.a - A1 * x.da) / A2,
            x.db,
            (x.a - x.b - A3 * x.db) / A4,
            (x.b - x.lag1) / T2,
            (lead1 - x.lag2) / T4,
            (lead2 - x.wash) / T6};
  }
};

}  // namespace swingbank::blind_second
