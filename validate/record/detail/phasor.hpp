#pragma once
// Phasors of three-phase waveforms, and their positive sequence.
#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace swingbank::validate::record {

/// One quantity in three phases, sampled evenly from t = 0, each phase with its own delay of sampling.
struct Waveforms {
  double rate = 0;                             ///< [1/s]
  std::array<std::vector<double>, 3> samples;  ///< phases a, b, c: instantaneous values
  std::array<double, 3> skew{};                ///< sampled that much later than stamped [s]
};

/// Phasors of the three phases at evenly spaced instants.
struct PhasorTrack {
  std::vector<double> t;                               ///< middle of each window [s]
  std::array<std::vector<std::complex<double>>, 3> x;  ///< rms, angle against cos(2 pi f0 t)
};

/// Slides a window of one nominal cycle (rectangular, one-cycle Fourier filter: Phadke and Thorp,
/// Synchronized Phasor Measurements and Their Applications, 2) over the waveforms, `phasors_per_second` times
/// a second, stamps in the middle. Harmonics and, off nominal, the negative-frequency image drop out of the
/// positive sequence of balanced waveforms; the magnitude falls short by 1 - sinc(f/f0 - 1): 0.05 % at 1 Hz
/// off. Samples at the window's ends count by the part of their interval inside, so that a cycle need not
/// hold a whole number of them. Empty if the waveforms are shorter than a cycle.
PhasorTrack phase_phasors(const Waveforms& waves, double nominal, double phasors_per_second);

/// Positive sequence of phasors of phases a, b, c, or of voltages ab, bc, ca, of which it is the one to
/// neutral: a third of sqrt(3), 30 degrees earlier.
std::complex<double> positive_sequence(const std::array<std::complex<double>, 3>& x, bool between);

/// What is wrong with the order or the signs of three phases by their sequence components, summed in
/// magnitude: the phase sequence A-C-B, or one phase reversed. Empty where the positive sequence prevails.
struct SequenceFault {
  std::string what, remedy;
};
std::optional<SequenceFault> sequence_fault(const std::array<std::vector<std::complex<double>>, 3>& x,
                                            const std::array<std::string, 3>& names);

}  // namespace swingbank::validate::record
