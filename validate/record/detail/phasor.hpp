#pragma once
// Phasors of three-phase waveforms, and their positive sequence.
#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace swingbank::validate::record {

/// One three-phase quantity, sampled evenly from t = 0, with a sampling delay for each phase.
struct Waveforms {
  double rate = 0;                             ///< [1/s]
  std::array<std::vector<double>, 3> samples;  ///< phases a, b, c: instantaneous values
  std::array<double, 3> skew{};                ///< delay of sampling after the time stamp [s]
};

/// Phasors of three phases at evenly spaced times.
struct PhasorTrack {
  std::vector<double> t;                               ///< middle of each window [s]
  std::array<std::vector<std::complex<double>>, 3> x;  ///< rms, angle against cos(2 pi f0 t)
};

/// Computes phasors with a sliding window of one nominal cycle (rectangular, one-cycle Fourier filter: Phadke
/// and Thorp, Synchronized Phasor Measurements and Their Applications, 2), `phasors_per_second` times a
/// second, with time stamps in the middle. At nominal frequency the window rejects harmonics. At off-nominal
/// frequency the positive sequence of balanced waveforms is free of the negative-frequency image. Its
/// magnitude is low by 1 - sinc(f/f0 - 1): 0.05 % at 1 Hz off nominal. Samples at the window's ends are
/// weighted by the part of their interval inside, so a cycle need not contain a whole number of samples.
/// Returns an empty track if the waveforms are shorter than a cycle.
PhasorTrack phase_phasors(const Waveforms& waves, double nominal, double phasors_per_second);

/// Returns the positive sequence of phasors a, b, c. For voltages ab, bc, ca, it is the line-to-neutral one:
/// divided by sqrt(3) and delayed by 30 degrees.
std::complex<double> positive_sequence(const std::array<std::complex<double>, 3>& x, bool between);

/// Error in the order or signs of three phases: phase sequence A-C-B, or one phase reversed.
struct SequenceFault {
  std::string what, why, remedy;
};
/// Finds the error by comparing the summed magnitudes of the sequence components; none if the positive
/// sequence dominates.
std::optional<SequenceFault> sequence_fault(const std::array<std::vector<std::complex<double>>, 3>& x,
                                            const std::array<std::string, 3>& names);

}  // namespace swingbank::validate::record
