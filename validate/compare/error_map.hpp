#pragma once
// Error map: residual of one channel per time window and frequency band, normalised by its coloured noise.
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::validate::compare {

/// Time window from < t <= to; the first one includes its start.
struct Window {
  std::string name;  ///< "pre-event", "fault", "0–1 s after", ...
  double from, to;   ///< [s]
};

/// Frequency band from <= f < to [Hz].
struct Band {
  std::string_view name;  ///< name in reports
  double from, to;        ///< limits [Hz]
};
/// Bands of slow responses (governor, set points), inter-area modes, local modes, and faster responses.
std::span<const Band> error_bands();

/// Stationary noise of one channel.
struct ChannelNoise {
  double sigma = 0;                ///< standard deviation [pu]
  std::vector<double> covariance;  ///< at lags of 0, 1, ... samples [pu^2]; zero beyond
  int samples = 0;                 ///< number of samples of the estimate; 0: the noise is known
  int freedom = 0;                 ///< degrees of freedom of the estimate; 0: the noise is known
  /// Returns the spectral density at frequency zero: variance of the mean of n samples, times n [pu^2].
  [[nodiscard]] double slow() const;
};

/// Estimates the noise from samples of a steady state, less their mean, by an autoregressive model (Levinson;
/// order by BIC, at most 8). `floor` [pu] is added as white noise, because interpolation leaves residuals in
/// records without noise. Needs at least 3 samples.
ChannelNoise estimate_noise(std::span<const double> quiet, double floor);

/// Time-frequency bin of an error map.
struct TimeFrequencyBin {
  /// Number of independent components; 0: the window is too short for the band, or is left out.
  int values = 0;
  double rms = 0;  ///< RMS of the residual's components in window and band [pu]
  /// Normalised RMS: square root of the mean of \f$ c_k^2 / \mathrm{var}(c_k) \f$ over the components, with
  /// variances under coloured noise; 1 for noise alone. It differs from rms / sigma, because a window or band
  /// contains only a part of the noise.
  double normalised = std::numeric_limits<double>::quiet_NaN();
  double bound = std::numeric_limits<double>::quiet_NaN();  ///< noise limit of `normalised`; see set_bounds()
  /// Whether the window is too short for the band, or is left out.
  [[nodiscard]] bool empty() const { return values == 0; }
  /// Returns the RMS that noise alone may reach [pu].
  [[nodiscard]] double allowed() const { return normalised > 0 ? rms / normalised * bound : 0.0; }
  /// Whether the normalised RMS exceeds the bound for noise.
  [[nodiscard]] bool exceeds() const { return !empty() && normalised > bound; }
};

/// Error map of one channel of one event.
struct ErrorMap {
  /// Bins of one window.
  struct Row {
    TimeFrequencyBin all;                 ///< every frequency, the mean included
    std::vector<TimeFrequencyBin> bands;  ///< in the order of error_bands()
  };
  std::vector<Row> rows;   ///< one per window
  TimeFrequencyBin whole;  ///< all windows, all frequencies
  int freedom = 0;         ///< degrees of freedom of the noise estimate; 0: the noise is known
};

/// Options of an error map.
struct ErrorMapOptions {
  int quiet = 0;  ///< number of pre-event samples whose mean is the operating point; 0: it is exact
  /// The model starts at the first window's mean, so that mean carries no information.
  bool starts_at_mean = true;
  std::string_view skip = {};  ///< name of a window to leave out: its bins stay empty
  /// Further random errors of the residual, one standard deviation each [shape][sample] [pu]; may be null.
  const std::vector<std::vector<double>>* shapes = nullptr;
};

/// Projects each window's residual on the window's orthonormal cosines (DCT-II; mode k has k half periods). A
/// mode belongs to the band of its frequency. White noise gives every mode the same variance. A band is empty
/// if the window is shorter than half a period of the band's upper edge. The window's mean then counts in
/// `all` only. After the first window, the variance of the mean includes the error of the operating point.
/// Large components leak: a normalised RMS of 100 in one band adds about 3 two bands away.
ErrorMap error_map(std::span<const double> t, std::span<const double> residual,
                   const std::vector<Window>& windows, const ChannelNoise& noise,
                   const ErrorMapOptions& options = {});

/// Returns the bound that the normalised RMS of `values` noise components exceeds with this probability: the
/// square root of the F distribution's quantile. `freedom` = 0 means a known variance.
double noise_bound(int values, int freedom, double probability);

/// Sets the bound of every bin of all maps so that noise alone exceeds any of the bounds with a probability
/// of at most `probability` (Bonferroni).
void set_bounds(std::span<ErrorMap* const> maps, double probability);

}  // namespace swingbank::validate::compare
