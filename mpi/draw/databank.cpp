#include "mpi/draw/databank.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "mpi/draw/detail/neighbours.hpp"
#include "mpi/draw/detail/plant_blocks.hpp"
#include "mpi/draw/detail/random.hpp"

namespace swingbank::mpi::draw {

namespace {

Neighbours make_neighbours(const DatasetConfig& config) {
  std::vector<double> low, width;
  for (const auto& b : config.box) {
    low.push_back(config.databank.scaled ? 0.0 : b.low);
    width.push_back(config.databank.scaled ? (b.sampled() ? 1.0 : 0.0) : b.high - b.low);
  }
  return {low, width, std::max(config.databank.distance, 1e-300)};
}

/// Number of candidates per batch (stop signals are checked after each batch), and per parallel task.
constexpr std::uint64_t kBatch = 8192, kPiece = 256;

std::string reasons(const Databank& bank) {
  std::string text = fmt::format("{} closer than the minimum distance", bank.too_close);
  for (const auto& [why, count] : bank.refused) text += fmt::format(", {} {}", count, why);
  return text;
}

/// Candidate sample with the results of the tests that do not depend on other candidates of the batch.
struct Candidate {
  std::vector<double> x, measured;  ///< values in parameter units; in units of the distance
  std::string why;                  ///< reason why it is inadmissible; empty if admissible
  bool near = false;                ///< whether it is too close to a sample of an earlier batch
};

/// Draws candidate `number`, a pure function of (seed, number), and tests its parameters.
void draw_one(const DatasetConfig& config, std::uint64_t number, BoxedPlant& plant, Candidate& c) {
  Random random(config.seed, Stream::databank, number);
  const std::size_t n = config.box.size();
  c.x.resize(n);
  c.measured.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Box& b = config.box[i];
    const double u = b.sampled() ? random.uniform() : 0.0;
    c.x[i] = b.low + (b.high - b.low) * u;
    c.measured[i] = config.databank.scaled ? u : c.x[i];
  }
  plant.set(c.x.data());
  c.why = objection(config, plant.plant());
}

/// Forecast of the number of candidates for the requested samples, to abort an infeasible request early. The
/// model: with n accepted samples, the fraction \f$ e^{-n/n_0} \f$ of the admissible candidates is far enough
/// from all accepted samples. For the GENROU box of the thesis (README.md) and a distance of 0.7, it predicts
/// the number of candidates for 15,000 to 240,000 samples within 8 %.
class Forecast {
 public:
  Forecast(std::uint64_t points, double patience)
      : points_(static_cast<double>(points)), patience_(patience) {}
  /// Returns a lower estimate of the total number of admissible candidates that are needed. `reached`:
  /// samples accepted so far; `admissible`: admissible candidates so far. Returns nothing until
  /// kEnoughTooClose candidates were too close.
  [[nodiscard]] std::optional<double> draws(double reached, double admissible) const {
    const double too_close = admissible - reached;
    if (too_close < kEnoughTooClose) return {};
    // Solves admissible = n0 (exp(reached / n0) - 1) for n0 by bisection.
    double low = 0.01 * reached, high = 1e3 * reached;
    for (int i = 0; i < 60; ++i) {
      const double n0 = std::sqrt(low * high);
      (n0 * std::expm1(std::min(reached / n0, 500.0)) > admissible ? low : high) = n0;
    }
    // Margins: three standard errors of the count of close candidates, and kTrust for the model error.
    const double n0 = high * (1.0 + 3.0 / std::sqrt(too_close)) * kTrust;
    return n0 * std::expm1(std::min(points_ / n0, 500.0));
  }
  [[nodiscard]] bool hopeless(double needed) const { return needed > patience_; }

 private:
  static constexpr double kEnoughTooClose = 100.0, kTrust = 1.25;
  double points_, patience_;
};

class Drawer {
 public:
  Drawer(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points)
      : config_(config),
        points_(points),
        patience_(config.databank.candidates_per_point * static_cast<double>(points) + 1000.0),
        forecast_(points, patience_),
        settled_(make_neighbours(config)),
        newest_(settled_),
        batch_(kBatch),
        plants_(static_cast<std::size_t>(omp_get_max_threads()), BoxedPlant(config, base)) {
    bank_.dimensions = config.box.size();
    reserve();
  }

  Databank run() {
    while (bank_.points() < points_ && !stop_asked()) {
      judge_batch();
      settle_batch();
      if (bank_.points() < points_) end_if_hopeless();
    }
    return std::move(bank_);
  }

 private:
  void reserve() {
    const double bytes =
        static_cast<double>(points_) * static_cast<double>(bank_.dimensions) * sizeof(double);
    try {
      bank_.values.reserve(points_ * bank_.dimensions);
    } catch (const std::exception&) {  // bad_alloc, length_error
      throw InputError({fmt::format("too little memory for a databank of {} samples", points_),
                        config_.file.string(), fmt::format("they take {:.1f} GB", bytes * 1e-9),
                        "lower `draws`, or raise fault.per_point"});
    }
  }
  /// Draws and tests the candidates of a batch in parallel.
  void judge_batch() {
    in_parallel(
        kBatch / kPiece,
        [&](std::size_t piece) {
          auto& plant = plants_[static_cast<std::size_t>(omp_get_thread_num())];
          for (std::size_t k = piece * kPiece; k < (piece + 1) * kPiece; ++k) {
            Candidate& c = batch_[k];
            draw_one(config_, bank_.candidates + k, plant, c);
            c.near = c.why.empty() && config_.databank.distance > 0 && settled_.near(c.measured.data());
          }
        },
        [](int) {});
  }
  /// Accepts candidates in order, so that the samples equal those of sequential drawing.
  void settle_batch() {
    const std::uint64_t first = bank_.candidates;
    std::vector<const Candidate*> accepted;
    for (const Candidate& c : batch_) {
      if (bank_.points() == points_) break;
      bank_.candidates = first + static_cast<std::uint64_t>(&c - batch_.data()) + 1;
      if (!c.why.empty()) {
        ++bank_.refused[c.why];
        continue;
      }
      ++admissible_;
      if (config_.databank.distance > 0) {
        if (c.near || newest_.near(c.measured.data())) {
          ++bank_.too_close;
          continue;
        }
        newest_.add(c.measured.data());
        accepted.push_back(&c);
      }
      bank_.values.insert(bank_.values.end(), c.x.begin(), c.x.end());
    }
    newest_.clear();
    for (const Candidate* c : accepted) settled_.add(c->measured.data());
  }
  void end_if_hopeless() const {
    const auto reached = static_cast<double>(bank_.points()), admissible = static_cast<double>(admissible_);
    const auto needed = forecast_.draws(reached, admissible);
    const bool hopeless = needed && forecast_.hopeless(*needed);
    // The sampling also ends after the allowed number of admissible candidates, or if the policy admits fewer
    // than one candidate in 1000.
    if (!hopeless && admissible <= patience_ && static_cast<double>(bank_.candidates) <= 1000.0 * patience_)
      return;
    std::string why = fmt::format("{} candidates: {}", bank_.candidates, reasons(bank_));
    if (hopeless)
      why += fmt::format(
          "; at this acceptance rate all samples would need at least {:.1e} admissible candidates, and {:.1e} are "
          "allowed",
          *needed, patience_);
    throw InputError(
        {fmt::format("databank reached {} of {} samples", bank_.points(), points_), config_.file.string(),
         why,
         "lower `draws` or databank.distance, choose another databank.scale, or raise fault.per_point or "
         "databank.candidates_per_point"});
  }

  const DatasetConfig& config_;
  std::uint64_t points_, admissible_ = 0;
  double patience_;  ///< largest number of admissible candidates
  Forecast forecast_;
  Databank bank_;
  Neighbours settled_, newest_;  ///< samples of earlier batches; of this batch
  std::vector<Candidate> batch_;
  std::vector<BoxedPlant> plants_;  ///< one per thread
};

}  // namespace

Databank draw_databank(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points) {
  return Drawer(config, base, points).run();
}

}  // namespace swingbank::mpi::draw
