#pragma once
// A round-rotor machine after P. W. Sauer and M. A. Pai, Power System Dynamics and Stability (1998), section
// 3.6 (two-axis model with one damper per axis). Saturation is that of PSS/E's GENROU: it acts on both axes
// and depends on the subtransient flux. Per unit on the machine's base. The stator voltage does not depend on
// speed. The prime mover sets the power, not the torque.
#include <cmath>
#include <complex>

namespace swingbank::blind_second {

using Phasor = std::complex<double>;
inline constexpr Phasor kJ{0.0, 1.0};
inline constexpr double kPi = 3.14159265358979323846;

struct MachineData {
  double Tdo1 = 7, Tdo2 = 0.05, Tqo1 = 0.8, Tqo2 = 0.06, H = 4, D = 0;
  double Xd = 1.8, Xq = 1.7, Xd1 = 0.35, Xq1 = 0.55, X2 = 0.25, Xl = 0.15, S10 = 0, S12 = 0, Ra = 0;
};
/// Rotor angle [rad], speed deviation, transient voltages, damper fluxes [pu].
struct Rotor {
  double delta = 0, w = 0, Eq1 = 0, Ed1 = 0, psi1 = 0, psi2 = 0;
};

/// Saturation Se(psi) = B (psi - A)^2/psi, with A and B from S10 at 1.0 pu and S12 at 1.2 pu.
inline double saturation(const MachineData& m, double psi) {
  if (!(m.S10 > 0)) return 0.0;
  const double ratio = std::sqrt(m.S10 / (1.2 * m.S12));
  const double A = (1.0 - 1.2 * ratio) / (1.0 - ratio);
  return psi > A ? m.S10 * std::pow((psi - A) / (1.0 - A), 2) / psi : 0.0;
}

/// Transforms from the network's frame to d + jq of the rotor.
inline Phasor to_dq(Phasor x, double delta) { return x * std::exp(-kJ * (delta - kPi / 2)); }
inline Phasor to_network(Phasor dq, double delta) { return dq * std::exp(kJ * (delta - kPi / 2)); }

/// Subtransient fluxes of both axes.
inline double flux_d(const MachineData& m, const Rotor& x) {
  return (x.Eq1 * (m.X2 - m.Xl) + x.psi1 * (m.Xd1 - m.X2)) / (m.Xd1 - m.Xl);
}
inline double flux_q(const MachineData& m, const Rotor& x) {
  return (-x.Ed1 * (m.X2 - m.Xl) + x.psi2 * (m.Xq1 - m.X2)) / (m.Xq1 - m.Xl);
}
/// Voltage behind Ra + jX'' in the network's frame.
inline Phasor internal_voltage(const MachineData& m, const Rotor& x) {
  return to_network(Phasor(-flux_q(m, x), flux_d(m, x)), x.delta);
}

struct Torques {
  double Te, Ifd;
};
/// Derivatives of the rotor's variables [1/s]; `current`: out of the machine.
inline Rotor rates(const MachineData& m, const Rotor& x, Phasor current, double Efd, double Pm, double hz,
                   Torques& out) {
  const Phasor i = to_dq(current, x.delta);
  const double Id = i.real(), Iq = i.imag(), fd = flux_d(m, x), fq = flux_q(m, x);
  const double Se = saturation(m, std::hypot(fd, fq));
  const double leak_d = m.Xd1 - m.Xl, leak_q = m.Xq1 - m.Xl;
  const double gap_d = x.psi1 + leak_d * Id - x.Eq1, gap_q = x.psi2 + leak_q * Iq + x.Ed1;
  Rotor r;
  out.Ifd = x.Eq1 + (m.Xd - m.Xd1) * (Id - (m.Xd1 - m.X2) / (leak_d * leak_d) * gap_d) + Se * fd;
  out.Te = fd * Iq - fq * Id;
  r.delta = 2 * kPi * hz * x.w;
  r.w = ((Pm - m.D * x.w) / (1.0 + x.w) - out.Te) / (2 * m.H);
  r.Eq1 = (Efd - out.Ifd) / m.Tdo1;
  r.Ed1 = (-x.Ed1 + (m.Xq - m.Xq1) * (Iq - (m.Xq1 - m.X2) / (leak_q * leak_q) * gap_q) +
           Se * fq * (m.Xq - m.Xl) / (m.Xd - m.Xl)) /
          m.Tqo1;
  r.psi1 = -gap_d / m.Tdo2;
  r.psi2 = -gap_q / m.Tqo2;
  return r;
}

/// Returns the rotor at rest that delivers `current` at terminal voltage `v`; sets the matching Efd and Pm.
inline Rotor at_rest(const MachineData& m, Phasor v, Phasor current, double& Efd, double& Pm) {
  const Phasor inner = v + Phasor(m.Ra, m.X2) * current;
  const double Se = saturation(m, std::abs(inner));
  const double ks = (m.Xq - m.Xl) / (m.Xd - m.Xl);
  Rotor x;
  x.delta = std::arg(inner + kJ * (m.Xq - m.X2) / (1.0 + ks * Se) * current);
  const Phasor i = to_dq(current, x.delta), e = to_dq(inner, x.delta);
  const double fd = e.imag(), fq = -e.real();
  x.Eq1 = fd + (m.Xd1 - m.X2) * i.real();
  x.psi1 = x.Eq1 - (m.Xd1 - m.Xl) * i.real();
  x.Ed1 = -fq - (m.Xq1 - m.X2) * i.imag();
  x.psi2 = -x.Ed1 - (m.Xq1 - m.Xl) * i.imag();
  Efd = x.Eq1 + (m.Xd - m.Xd1) * i.real() + Se * fd;
  Pm = fd * i.imag() - fq * i.real();
  return x;
}

}  // namespace swingbank::blind_second
