#pragma once
// Positive-sequence phasors of three-phase waveforms.
#include <array>
#include <complex>
#include <vector>

namespace swingbank::validate::record {

/// One quantity in three phases, sampled evenly from t = 0, each phase with its own delay of sampling.
struct Waveforms {
  double rate = 0;                             ///< [1/s]
  std::array<std::vector<double>, 3> samples;  ///< phases a, b, c: instantaneous values
  std::array<double, 3> skew{};                ///< sampled that much later than stamped [s]
};

/// Phasors at evenly spaced instants.
struct PhasorTrack {
  std::vector<double> t;                ///< middle of each window [s]
  std::vector<std::complex<double>> x;  ///< rms, angle against cos(2 pi f0 t)
};

/// Slides a window of one nominal cycle (rectangular, one-cycle Fourier filter: Phadke and Thorp,
/// Synchronized Phasor Measurements and Their Applications, 2) over the waveforms, `phasors_per_second` times
/// a second, stamps in the middle. Harmonics and, off nominal, the negative-frequency image drop out of the
/// positive sequence of balanced waveforms; the magnitude falls short by 1 - sinc(f/f0 - 1): 0.05 % at 1 Hz
/// off. Samples at the window's ends count by the part of their interval inside, so that a cycle need not
/// hold a whole number of them. Empty if the waveforms are shorter than a cycle.
PhasorTrack positive_sequence(const Waveforms& waves, double nominal, double phasors_per_second);

}  // namespace swingbank::validate::record
