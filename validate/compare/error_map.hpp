#pragma once
// Where a model is wrong: the residual of one channel per window of time and band of frequency, normalised by
// the coloured noise of the channel.
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::validate::compare {

/// A stretch of the record: from < t <= to (the first one includes its start).
struct Window {
  std::string name;
  double from, to;  ///< [s]
};

/// from <= f < to [Hz].
struct Band {
  std::string_view name;
  double from, to;
};
/// Slow (governor, set points), swings between areas, swings of the plant, and what is faster.
std::span<const Band> error_bands();

/// Stationary noise of one channel.
struct ChannelNoise {
  double sigma = 0;                ///< standard deviation [pu]
  std::vector<double> covariance;  ///< at lags of 0, 1, ... samples [pu^2]; zero beyond
  int samples = 0;                 ///< number of samples it was estimated from; 0: known
  int freedom = 0;                 ///< degrees of freedom of the estimate; 0: known
  /// Variance of the mean of many samples, times their number.
  [[nodiscard]] double slow() const;
};

/// Noise from a stretch in which nothing happens: its mean is taken off, and an autoregressive model
/// (Levinson; order by BIC, at most 8) says how the noise is coloured. `floor` [pu] is added as white noise:
/// what a computation leaves where a record has no noise. Needs at least 3 samples.
ChannelNoise estimate_noise(std::span<const double> quiet, double floor);
/// Known white noise.
ChannelNoise white_noise(double sigma);

struct MapCell {
  /// Independent values in the cell; 0: the window is too short for the band, nothing is known.
  int values = 0;
  double rms = 0;  ///< of the residual's part in window and band [pu]
  /// Normalised RMS: sqrt(mean of the squared components, each over its variance under coloured noise); 1
  /// for noise alone. It is not rms / sigma: a window or band holds a part of the noise only.
  double normalised = std::numeric_limits<double>::quiet_NaN();
  double bound = std::numeric_limits<double>::quiet_NaN();  ///< noise alone stays below; set by set_bounds()
  [[nodiscard]] bool empty() const { return values == 0; }
  /// What noise alone may leave [pu].
  [[nodiscard]] double allowed() const { return normalised > 0 ? rms / normalised * bound : 0.0; }
  [[nodiscard]] bool exceeds() const { return !empty() && normalised > bound; }
};

/// One channel of one event.
struct ErrorMap {
  struct Row {
    MapCell all;                 ///< every frequency, the mean included
    std::vector<MapCell> bands;  ///< as error_bands()
  };
  std::vector<Row> rows;  ///< one per window
  MapCell whole;          ///< all windows, all frequencies
  int freedom = 0;        ///< of the noise's estimate; 0: known
};

struct ErrorMapOptions {
  int quiet = 0;  ///< samples before the event, whose mean is the model's start; 0: the start is exact
  /// The first window's mean tells nothing: the model starts there.
  bool starts_at_mean = true;
  std::string_view skip = {};  ///< name of a window to leave out: its cells stay empty
  /// What else may be in the residual by chance, one standard deviation each [shape][sample] [pu]; may be
  /// null.
  const std::vector<std::vector<double>>* shapes = nullptr;
};

/// Projects each window's residual on the orthonormal cosines of that window (DCT-II; mode k has k half
/// periods). A mode belongs to the band of its frequency, and white noise of any window gives each mode the
/// same variance. A band is empty where the window is shorter than half a period of the band's upper end; the
/// mean of such a window is in `all` only. After the first window the mean also carries the error of the
/// start. A large component leaks: of one of 100 x some 3 x are seen two bands away.
ErrorMap error_map(std::span<const double> t, std::span<const double> residual,
                   const std::vector<Window>& windows, const ChannelNoise& noise,
                   const ErrorMapOptions& options = {});

/// The bound that sqrt(mean square of `values` noise values / estimated variance) exceeds with this
/// probability. It is the square root of the F distribution's quantile; `freedom` = 0 stands for a known
/// variance.
double noise_bound(int values, int freedom, double probability);

/// Bound of every cell of all maps such that noise alone exceeds any of them with at most `probability`
/// (Bonferroni).
void set_bounds(std::span<ErrorMap* const> maps, double probability);

}  // namespace swingbank::validate::compare
