#pragma once
// One event made ready for fitting: where the voltage jumps, where the model starts, and how large the noise
// is in each channel.
#include <Eigen/Dense>
#include <algorithm>
#include <memory>
#include <vector>

#include "validate/event/innovations.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/playin/driven_plant.hpp"

namespace swingbank::validate::event {

struct FitEvent {
  record::Record record;
  std::vector<playin::Switching> switchings;  ///< where they were found; those with an uncertainty are fitted
  playin::OperatingPoint start;
  /// Marks samples that an instrument's filter has smeared over a switching; these are not played in. Empty:
  /// no sample is.
  std::vector<char> smeared = {};
  /// Marks samples that are not compared: the smeared ones, and those next to a sharp switching, because a
  /// channel that is a millisecond late may lie on the other side there. Empty: no sample is.
  std::vector<char> left_out = {};
  /// Time, V and theta of the samples that are not smeared, and of those that unsmear() brought back. Empty
  /// where none is smeared.
  record::Record clean = {};
  std::vector<playin::Output> channels;  ///< measured ones: P, Q, then speed, Efd, Ifd where recorded
  Eigen::VectorXd noise;                 ///< standard deviation per channel [pu]
  Eigen::MatrixXd whitening;  ///< W, lower triangular: W e has unit covariance where e is white noise
  std::shared_ptr<const Innovations> memory = nullptr;  ///< memory of the noise, where it is not white
  /// One of Response's answers or slopes ([output][sample]), with the measured values taken off where asked:
  /// [compared sample * channels + channel].
  [[nodiscard]] Eigen::VectorXd collected(const std::vector<double>* values, bool less_measured) const;
  /// Whitens residuals, or changes of the answer, in place: [compared sample * channels + channel][column].
  void whiten(RowMatrix& e) const;
  [[nodiscard]] const std::vector<double>& measured(playin::Output o) const;
  /// The record that is played in.
  [[nodiscard]] const record::Record& played() const { return smeared.empty() ? record : clean; }
  [[nodiscard]] bool compared(std::size_t sample) const { return left_out.empty() || !left_out[sample]; }
  /// How many numbers are compared.
  [[nodiscard]] int values() const {
    const auto missing = std::ranges::count(left_out, 1);
    return (record.samples() - static_cast<int>(missing)) * static_cast<int>(channels.size());
  }
};

/// What an instrument does to jumps: it smears all or none.
enum class Jumps { either, sharp, spread };

struct FitEventOptions {
  bool measured_states = true;  ///< compare speed, Efd and Ifd too, where they are recorded
  double jump_threshold = playin::kJumpThreshold;
  double pre_event = 1.0;       ///< length of the steady window where nothing is switched [s]
  Jumps jumps = Jumps::either;  ///< either: the records tell (jumps_of)
};

/// Finds switchings even where a filter has spread their jumps over two or three sample intervals. `smeared`
/// gets a mark for each sample that lies inside such a jump or beside it. If jumps are known to be spread,
/// the neighbours of sharp ones are marked too; if they are known to be sharp, a spread step is a swing.
std::vector<playin::Switching> find_switchings(const record::Record& record, double threshold, Jumps jumps,
                                               std::vector<char>& smeared);

/// What one instrument does to jumps, by all of its records. Their first jumps decide, because later ones may
/// be those of a swing. `either` where no record tells.
Jumps jumps_of(const std::vector<record::Record>& records, double threshold);

/// Prepares records that belong together (one plant, one instrument). The noise is that of the pre-event
/// residual of `model`, pooled over the events: what the played-in voltage's own noise adds through the
/// machine's reactance is in it, and so is what ties P and Q together. `kLeastNoise` is its floor. Throws
/// InputError if a record has no pre-event.
std::vector<FitEvent> prepare_events(const plant::PlantModel& model, std::vector<record::Record> records,
                                     const FitEventOptions& options = {});

/// Measures the noise anew with another model of the plant, because a reactance that is wrong by a fifth
/// makes the noise wrong by a fifth.
void measure_noise(const sim::plant::Plant& plant, const sim::Conventions& conventions,
                   std::vector<FitEvent>& events);

/// Interpolation between samples leaves residuals of this size where a record has no noise at all [pu].
constexpr double kLeastNoise = 1e-4;
/// The same for the speed [pu]. It is what an error of 1e-4 pu of P that lasts a tenth of a second does to a
/// machine of H = 1 s.
constexpr double kLeastSpeedNoise = 5e-6;

}  // namespace swingbank::validate::event
