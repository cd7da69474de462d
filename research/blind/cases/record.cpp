// Simulated instruments of blind cases: phasors, filter and noise, and the record as CSV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/constants.hpp"
#include "research/blind/cases/detail/world.hpp"
#include "sim/library/library.hpp"

namespace swingbank::research::blind::cases {
namespace {

/// Time simulated beyond the record [s], at least the look-ahead of the filters: one cycle for class P; half
/// the window at 30/s for class M.
constexpr double kAhead = 0.05, kAheadM = 0.2;

enum FineChannel { kFineV, kFineTheta, kFineP, kFineQ, kFineSpeed, kFineIfd };

/// Applies the reference class P filter of IEEE Std C37.118.1-2011, annex C: triangular over two cycles of
/// nominal frequency, w(k) = 1 - 2|k|/(N + 2), normalised. The first and the last value are repeated beyond
/// the ends of the series.
std::vector<Complex> p_class(const std::vector<Complex>& x, double rate, double frequency) {
  const int half = static_cast<int>(std::lround(rate / frequency)) - 1;
  const int last = static_cast<int>(x.size()) - 1;
  std::vector<double> weight;
  double sum = 0;
  for (int k = -half; k <= half; ++k) {
    weight.push_back(1.0 - std::abs(k) / (half + 1.0));
    sum += weight.back();
  }
  std::vector<Complex> y(x.size());
  for (int i = 0; i <= last; ++i)
    for (int k = -half; k <= half; ++k)
      y[static_cast<std::size_t>(i)] += weight[static_cast<std::size_t>(k + half)] / sum *
                                        x[static_cast<std::size_t>(std::clamp(i + k, 0, last))];
  return y;
}

/// Applies the reference class M filter for the reporting rate `reports` [1/s].
void m_class(sim::Phasors& p, double reports) {
  const sim::Effect& filter = *sim::library::compiled().find("PMUFILTER");
  std::vector<double> values = filter.default_parameters();
  values[static_cast<std::size_t>(filter.parameter_index("class"))] = 1.0;
  values[static_cast<std::size_t>(filter.parameter_index("reports"))] = reports;
  filter.measure(values.data(), 0, p);
}

/// Returns the total power of all recorded units [pu on the base of the first].
Complex power(const sim::reference::ReferenceRun& fine, std::span<const double> mva, int k) {
  Complex sum = 0;
  for (std::size_t u = 0; u < mva.size(); ++u) {
    const int unit = static_cast<int>(u);
    sum += Complex(fine.at(unit, kFineP)[k], fine.at(unit, kFineQ)[k]) * mva[u] / mva[0];
  }
  return sum;
}

sim::Phasors phasors(const sim::reference::ReferenceRun& fine, std::span<const double> mva,
                     double frequency) {
  sim::Phasors p;
  p.rate = fine.rate;
  p.frequency = frequency;
  for (int k = 0; k < fine.samples; ++k) {
    const Complex v = std::polar(fine.at(0, kFineV)[k], fine.at(0, kFineTheta)[k]);
    p.V.push_back(v);
    p.I.push_back(std::conj(power(fine, mva, k) / v));
    const double* theta = fine.at(0, kFineTheta);
    p.df.push_back(k == 0 ? 0.0 : (theta[k] - theta[k - 1]) * fine.rate / (constants::turn * frequency));
  }
  return p;
}

}  // namespace

sim::reference::ReferenceRun simulate_fine(const sim::grid::Grid& grid, const std::vector<int>& plants,
                                           const BlindEvent& event, const BlindConfig& config) {
  sim::reference::ReferenceOptions options;
  options.rate = config.fine_rate;
  const bool class_m = config.conditions.class_m_share > 0;
  options.t_end = event.seconds + (class_m ? kAheadM : kAhead);
  options.plants = plants;
  options.channels = {sim::Channel::V, sim::Channel::theta, sim::Channel::P,
                      sim::Channel::Q, sim::Channel::speed, sim::Channel::Ifd};
  return sim::reference::run_reference(grid, event.event, options);
}

validate::record::Record measured(const sim::reference::ReferenceRun& fine, const sim::plant::Plant& plant,
                                  const BlindEvent& event, const Conditions& conditions, double frequency,
                                  std::uint64_t seed, const sim::plant::Plant* other) {
  std::vector<double> mva = {plant.mva};
  if (other) mva.push_back(other->mva);
  sim::Phasors p = phasors(fine, mva, frequency);
  for (const sim::plant::Block& block : plant.measurements) block.effect->measure(block.p.data(), seed, p);
  if (conditions.filter == Filter::class_p) {
    p.V = p_class(p.V, fine.rate, frequency);
    p.I = p_class(p.I, fine.rate, frequency);
  } else if (conditions.filter == Filter::class_m) {
    m_class(p, conditions.rate);
  }
  validate::record::Record r;
  r.base.mva = kRecordMva;
  r.base.frequency = frequency;
  const int stride = static_cast<int>(std::lround(fine.rate / conditions.rate));
  const double begin = event.switchings.empty() ? 0.0 : event.switchings.front() - conditions.lead;
  const double scale = plant.mva / kRecordMva;
  for (int k = 0; k <= static_cast<int>(std::lround(event.seconds * fine.rate)); k += stride) {
    const auto i = static_cast<std::size_t>(k);
    const double t = static_cast<double>(k / stride) / conditions.rate;
    if (t < begin) continue;
    const Complex power = p.V[i] * std::conj(p.I[i]) * scale;
    double angle = std::arg(p.V[i]);
    angle += conditions.wander * std::sin(constants::turn * t / conditions.wander_s);
    if (!r.theta.empty()) angle += constants::turn * std::round((r.theta.back() - angle) / constants::turn);
    r.t.push_back(t);
    r.V.push_back(std::abs(p.V[i]));
    r.theta.push_back(angle);
    r.P.push_back(power.real());
    r.Q.push_back(power.imag());
    r.speed.push_back(fine.at(0, kFineSpeed)[k]);
    r.Ifd.push_back(fine.at(0, kFineIfd)[k]);
  }
  return r;
}

void add_noise(validate::record::Record& record, const RecordNoise& noise, bool channels, BlindDraw& draw) {
  const auto add = [&](std::vector<double>& values, double sigma) {
    for (double& value : values) value += sigma * draw.normal();
  };
  add(record.V, noise.voltage);
  add(record.theta, noise.voltage);
  add(record.P, noise.power * noise.mva / kRecordMva);
  add(record.Q, noise.power * noise.mva / kRecordMva);
  add(record.speed, noise.speed);
  add(record.Ifd, noise.power);
  if (channels) return;
  record.speed.clear();
  record.Ifd.clear();
}

std::string record_csv(const validate::record::Record& record) {
  std::string text = "t_s,V_pu,theta_rad,P_pu,Q_pu";
  if (!record.speed.empty()) text += ",omega_pu,Ifd_pu";
  text += '\n';
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    fmt::format_to(std::back_inserter(text), "{:.6f},{:.7g},{:.7g},{:.7g},{:.7g}", record.t[k], record.V[k],
                   record.theta[k], record.P[k], record.Q[k]);
    if (!record.speed.empty())
      fmt::format_to(std::back_inserter(text), ",{:.9g},{:.7g}", 1.0 + record.speed[k], record.Ifd[k]);
    text += '\n';
  }
  return text;
}

}  // namespace swingbank::research::blind::cases
