#pragma once
// Rotating exciter with a lead-lag and a regulator: DC1 (IEEEX1, ESDC1A) with fixed limits, and the part
// shared with EXDC2. A Model declares by `ends_at_zero` whether the lower limit of its field voltage is zero.
#include "sim/effects/detail/rotating_dc.hpp"
#include "sim/effects/detail/sources.hpp"

namespace swingbank::sim::effects::shared {

/// A Model must have the functions regulator(c, x, u, V, dx) and hindrance(c, Vr, V). The latter returns the
/// reason why Vr cannot have its steady value, or "".
template <class Model>
struct DcBehindLeadLag : RotatingDc<Model> {
  using Dc = RotatingDc<Model>;
  enum P { TR, KA, TA, TB, TC, VRMAX, VRMIN, KE, TE, KF, TF, SWITCH, E1, SE1, E2, SE2 };
  static constexpr int dyr_columns[] = {TR, KA, TA, TB,     TC, VRMAX, VRMIN, KE,
                                        TE, KF, TF, SWITCH, E1, SE1,   E2,    SE2};
  enum C {
    iTR,
    gain,
    iTA,
    lead,
    iTB,
    vrmax,
    vrmin,
    self,
    iTE,
    feedback,
    iTF,
    satA,
    satB,
    none,
    Vref,
    coefficients
  };
  enum X { Vm, leadlag, Vr, Efd, rate };

  static void check(const double* p, const std::string& where, Problems& problems) {
    Dc::check_with({TR, TA, TB}, {Model::name, Model::parameters, p, where, problems}, p);
  }
  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    Dc::prepare(p, conventions, c);
    c[lead] = p[TC];
    c[iTB] = inverse(p[TB]);
    c[none] = T(0.0);
  }
  template <class T>
  static void evaluate(const T* c, const T* x, Signals<T>& s, T* dx) {
    const T error = Dc::voltage_error(c, x, s, dx);
    const T u = lead_lag(c[lead], c[iTB], x[leadlag], error, dx[leadlag]);
    Dc::excite(c, x, Model::regulator(c, x, u, s.V, dx), s, dx);
    if constexpr (Model::ends_at_zero) s.Efd = positive_part(s.Efd);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    const std::string why = Dc::steady_exciter(p, c, s, x);
    if (!why.empty()) return why;
    if (std::string reason = Model::hindrance(c, x[Vr], s.V); !reason.empty()) return reason;
    x[leadlag] = x[Vr] / p[KA];
    c[Vref] = x[leadlag] + s.Vc - s.Vs - s.Vlimiter;
    return {};
  }
};

template <class Model>
struct DcTypeOne : DcBehindLeadLag<Model> {
  using Dc = RotatingDc<Model>;
  using B = DcBehindLeadLag<Model>;
  static constexpr Source defaults_from = literature::openipsl("IEEEX1, defaults");
  static constexpr Source bounds_from = kBeyondCases;
  static constexpr Parameter parameters[] = {
      Dc::kTR,
      {"KA", "KA", "pu", 40.0, 1.0, 1000.0, kNoNullValue, "regulator gain"},
      {"TA", "TA", "s", 0.04, 0.0, 10.0, kNoNullValue, "regulator time constant (0: none)"},
      {"TB", "TB", "s", 2.0, 0.0, 50.0, kNoNullValue, "lag (0: bypass)",
       literature::own("halves the transient gain; the case files have no lead-lag")},
      {"TC", "TC", "s", 1.0, 0.0, 50.0, kNoNullValue, "lead",
       literature::own("halves the transient gain; the case files have no lead-lag")},
      Dc::kVRMAX,
      Dc::kVRMIN,
      Dc::kKE,
      Dc::kTE,
      {"KF", "KF", "pu", 0.03, 0.0, 1.0, 0.0, "gain of the rate feedback"},
      Dc::kTF,
      Dc::kSwitch,
      Dc::kE1,
      Dc::kSE1,
      Dc::kE2,
      Dc::kSE2};

  template <class T>
  static T regulator(const T* c, const T* x, const T& u, const T&, T* dx) {
    return clamp(lag(c[B::iTA], x[B::Vr], c[B::gain] * u, dx[B::Vr]), c[B::vrmin], c[B::vrmax]);
  }
  template <class T>
  static std::string hindrance(const T*, const T&, const T&) {
    return {};  // the state's own limits apply
  }
};

}  // namespace swingbank::sim::effects::shared
