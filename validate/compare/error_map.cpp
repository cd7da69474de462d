#include "validate/compare/error_map.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "base/constants.hpp"

namespace swingbank::validate::compare {
namespace {

constexpr Band kBands[] = {{"< 0.1 Hz", 0.0, 0.1},
                           {"0.1–0.8 Hz", 0.1, 0.8},
                           {"0.8–3 Hz", 0.8, 3.0},
                           {"> 3 Hz", 3.0, std::numeric_limits<double>::infinity()}};

/// Returns the biased autocovariance of x (sum divided by n) at lags 0 ... most.
std::vector<double> autocovariance(std::span<const double> x, int most) {
  const auto n = x.size();
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(n);
  std::vector<double> r;
  for (std::size_t lag = 0; lag <= static_cast<std::size_t>(most); ++lag) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < n; ++i) sum += (x[i] - mean) * (x[i + lag] - mean);
    r.push_back(sum / static_cast<double>(n));
  }
  return r;
}

/// Returns the autoregressive coefficients, x[i] = a[0] x[i-1] + a[1] x[i-2] + ... + e, of the order with the
/// lowest BIC (Levinson recursion).
std::vector<double> autoregression(const std::vector<double>& r, std::size_t n) {
  std::vector<double> a, best;
  double rest = r[0], least = std::log(r[0]);
  for (std::size_t p = 1; p < r.size(); ++p) {
    double reflection = r[p];
    for (std::size_t j = 0; j < a.size(); ++j) reflection -= a[j] * r[p - 1 - j];
    reflection /= rest;
    std::vector<double> next = a;
    for (std::size_t j = 0; j < a.size(); ++j) next[j] -= reflection * a[a.size() - 1 - j];
    next.push_back(reflection);
    a = std::move(next);
    rest *= 1 - reflection * reflection;
    if (!(rest > 0)) break;
    const double size = static_cast<double>(n);
    if (const double bic = std::log(rest) + static_cast<double>(p) * std::log(size) / size; bic < least)
      least = bic, best = a;
  }
  return best;
}

/// Orthonormal cosines of a window of n samples: mode k is a_k cos(pi k (2 i + 1) / 2n).
class Cosines {
 public:
  explicit Cosines(std::size_t n) : n_(n), table_(4 * n) {
    for (std::size_t i = 0; i < 4 * n; ++i)
      table_[i] = std::cos(constants::pi * static_cast<double>(i) / (2.0 * static_cast<double>(n)));
  }
  /// Returns the coefficients of the discrete cosine transforms of all series. Each Fourier transform
  /// contains two series, with samples of even indices in ascending order, then those of odd indices in
  /// descending order (Makhoul 1980).
  [[nodiscard]] std::vector<std::vector<double>> coefficients(
      const std::vector<std::span<const double>>& series) {
    std::vector<std::vector<double>> all(series.size(), std::vector<double>(n_));
    std::vector<std::complex<double>> folded(n_), modes;
    for (std::size_t s = 0; s < series.size(); s += 2) {
      const bool pair = s + 1 < series.size();
      for (std::size_t i = 0; i < n_; ++i)
        folded[i % 2 == 0 ? i / 2 : n_ - 1 - i / 2] = {series[s][i], pair ? series[s + 1][i] : 0.0};
      if (n_ == 1)
        modes = folded;  // kissfft reads out of bounds if there is only one sample
      else
        fft_.fwd(modes, folded);
      for (std::size_t k = 0; k < n_; ++k) {
        const std::complex<double> mode = modes[k], mirror = std::conj(modes[(n_ - k) % n_]),
                                   turn(table_[k], -sine(k));
        const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n_)) / 2;
        all[s][k] = scale * ((mode + mirror) * turn).real();
        if (pair) all[s + 1][k] = scale * ((mode - mirror) * turn).imag();
      }
    }
    return all;
  }
  /// Returns the variance of coefficient k under noise: sum over lags d of the covariance times
  /// sum_i b(i) b(i + d), a geometric series.
  [[nodiscard]] double variance(const ChannelNoise& noise, std::size_t k) const {
    const double n = static_cast<double>(n_);
    double sum = noise.covariance[0];
    for (std::size_t lag = 1; lag < std::min(noise.covariance.size(), n_); ++lag) {
      const double m = n - static_cast<double>(lag);
      const std::size_t angle = 2 * k * lag;  // in units of pi / 2n
      const double overlap = k == 0 ? m / n : (m * table_[angle % (4 * n_)] - sine(angle) / sine(2 * k)) / n;
      sum += 2 * noise.covariance[lag] * overlap;
    }
    return std::max(sum, 1e-3 * noise.covariance[0]);  // a truncated covariance may give a negative sum
  }

 private:
  /// sin(pi i / 2n).
  [[nodiscard]] double sine(std::size_t i) const { return table_[(i + 3 * n_) % (4 * n_)]; }

  std::size_t n_;
  std::vector<double> table_;
  Eigen::FFT<double> fft_;
};

/// Accumulator of a bin.
struct Filling {
  int values = 0;
  double square = 0, relative = 0;
  void add(double c, double variance) {
    ++values;
    square += c * c;
    relative += c * c / variance;
  }
  void add(const Filling& other) {
    values += other.values;
    square += other.square;
    relative += other.relative;
  }
  [[nodiscard]] TimeFrequencyBin bin(std::size_t samples) const {
    TimeFrequencyBin c;
    c.values = values;
    if (values == 0) return c;
    c.rms = std::sqrt(square / static_cast<double>(samples));
    c.normalised = std::sqrt(relative / values);
    return c;
  }
};

struct WindowFilling {
  Filling all;
  std::vector<Filling> bands{std::size(kBands)};
};

WindowFilling fill(std::span<const double> x, double step, const ChannelNoise& noise, double start_error,
                   bool skip_mean, const std::vector<std::span<const double>>& shapes) {
  WindowFilling f;
  Cosines cosines(x.size());
  std::vector<std::span<const double>> series = shapes;
  series.push_back(x);
  std::vector<std::vector<double>> parts = cosines.coefficients(series);
  const std::vector<double> own = std::move(parts.back());
  parts.pop_back();
  const double length = static_cast<double>(x.size()) * step;
  for (std::size_t k = skip_mean ? 1 : 0; k < x.size(); ++k) {
    const double frequency = static_cast<double>(k) / (2 * length);
    double variance = cosines.variance(noise, k);
    if (k == 0) variance += static_cast<double>(x.size()) * start_error;
    for (const auto& part : parts) variance += part[k] * part[k];
    const double c = own[k];
    f.all.add(c, variance);
    for (std::size_t b = 0; b < std::size(kBands); ++b)
      if (frequency >= kBands[b].from && frequency < kBands[b].to && 2 * length * kBands[b].to >= 1)
        f.bands[b].add(c, variance);
  }
  return f;
}

/// Returns the index range [first, last) of a window.
std::pair<std::size_t, std::size_t> samples_of(std::span<const double> t, const Window& w, bool first) {
  const auto begin = first ? std::ranges::lower_bound(t, w.from) : std::ranges::upper_bound(t, w.from);
  const auto end = std::ranges::upper_bound(t, w.to);
  return {static_cast<std::size_t>(begin - t.begin()),
          static_cast<std::size_t>(std::max(begin, end) - t.begin())};
}

}  // namespace

std::span<const Band> error_bands() { return kBands; }

double ChannelNoise::slow() const {
  double sum = covariance[0];
  for (std::size_t d = 1; d < covariance.size(); ++d) sum += 2 * covariance[d];
  return std::max(sum, 0.0);
}

ChannelNoise estimate_noise(std::span<const double> quiet, double floor) {
  const auto n = quiet.size();
  const int most = std::clamp(static_cast<int>(n) / 15, 0, 8);
  std::vector<double> r = autocovariance(quiet, most);
  const double bessel = static_cast<double>(n) / static_cast<double>(n - 1);
  ChannelNoise noise;
  noise.samples = static_cast<int>(n);
  std::vector<double> a;
  if (r[0] > floor * floor) a = autoregression(r, n);
  std::vector<double>& c = noise.covariance;
  c = {r[0]};
  constexpr std::size_t kLongestCovariance =
      400;  // samples; longer than the memory of a slowly filtered channel
  while (!a.empty() && c.size() < kLongestCovariance) {
    const std::size_t lag = c.size();
    double next = 0;
    if (lag <= a.size())
      next = r[lag];
    else
      for (std::size_t j = 0; j < a.size(); ++j) next += a[j] * c[lag - 1 - j];
    c.push_back(next);
    if (lag > a.size() + 8 && std::abs(next) < 1e-4 * r[0] && std::abs(c[lag - 1]) < 1e-4 * r[0]) break;
  }
  for (double& v : c) v *= bessel;
  c[0] += floor * floor;
  noise.sigma = std::sqrt(c[0]);
  // A spectrum of p coefficients from n samples has about n / p degrees of freedom.
  noise.freedom = std::max(1, static_cast<int>((n - 1) / (a.size() + 1)));
  return noise;
}

ErrorMap error_map(std::span<const double> t, std::span<const double> residual,
                   const std::vector<Window>& windows, const ChannelNoise& noise,
                   const ErrorMapOptions& options) {
  ErrorMap map;
  map.freedom = noise.freedom;
  const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  const double start_error = options.quiet > 0 ? noise.slow() / options.quiet : 0.0;
  Filling whole;
  std::size_t total = 0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const auto [begin, end] = samples_of(t, windows[w], w == 0);
    ErrorMap::Row row;
    row.bands.resize(std::size(kBands));
    if (end > begin && (options.skip.empty() || windows[w].name != options.skip)) {
      const bool first = w == 0;
      std::vector<std::span<const double>> shapes;
      if (options.shapes)
        for (const auto& shape : *options.shapes)
          shapes.push_back(std::span(shape).subspan(begin, end - begin));
      const WindowFilling f = fill(residual.subspan(begin, end - begin), step, noise,
                                   first ? 0.0 : start_error, first && options.starts_at_mean, shapes);
      row.all = f.all.bin(end - begin);
      for (std::size_t b = 0; b < row.bands.size(); ++b) row.bands[b] = f.bands[b].bin(end - begin);
      whole.add(f.all);
      total += end - begin;
    }
    map.rows.push_back(std::move(row));
  }
  map.whole = whole.bin(std::max<std::size_t>(total, 1));
  return map;
}

void set_bounds(std::span<ErrorMap* const> maps, double probability) {
  const auto each = [&](const auto& action) {
    for (ErrorMap* map : maps) {
      action(map->whole, map->freedom);
      for (auto& row : map->rows) {
        action(row.all, map->freedom);
        for (auto& bin : row.bands) action(bin, map->freedom);
      }
    }
  };
  int bins = 0;
  each([&](const TimeFrequencyBin& bin, int) { bins += bin.empty() ? 0 : 1; });
  each([&](TimeFrequencyBin& bin, int freedom) {
    if (!bin.empty()) bin.bound = noise_bound(bin.values, freedom, probability / bins);
  });
}

}  // namespace swingbank::validate::compare
