#pragma once
// Simulated system of one blind case: randomly drawn grid, plants, controls and events, with hidden effects
// of variable size.
#include <array>
#include <optional>
#include <span>

#include "research/blind/cases/case.hpp"
#include "research/blind/cases/detail/conditions.hpp"
#include "research/blind/cases/detail/random.hpp"
#include "sim/grid/grid.hpp"
#include "sim/reference/reference.hpp"
#include "validate/event/event.hpp"
#include "validate/noise/noise_model.hpp"

namespace swingbank::research::blind::cases {

inline constexpr double kRecordMva = 100.0;  ///< base of P_pu and Q_pu in blind records [MVA]

class BlindWorld {
 public:
  /// Draws grid, plant, true parameters and controls. Throws InputError if they are incompatible.
  BlindWorld(const BlindConfig& config, const std::vector<const BlindKind*>& hidden, BlindDraw& draw);

  /// Returns the grid with each hidden effect at its scale; nullopt omits an effect.
  [[nodiscard]] sim::grid::Grid grid(std::span<const std::optional<double>> scale) const;
  /// Returns the grid without hidden effects.
  [[nodiscard]] const sim::grid::Grid& plain() const { return grid_; }
  [[nodiscard]] int plant() const { return plant_; }
  [[nodiscard]] const std::string& grid_name() const { return name_; }
  [[nodiscard]] bool controlled() const { return controlled_; }
  [[nodiscard]] bool converter() const {
    return grid_.plants[static_cast<std::size_t>(plant_)].machine.effect->converter;
  }
  /// Returns the indices of the plants whose P and Q are recorded together, plant() first.
  [[nodiscard]] const std::vector<int>& recorded() const { return recorded_; }
  /// Returns whether the plant is recorded behind a transformer that its model contains.
  [[nodiscard]] bool transformed() const { return transformed_; }

 private:
  void draw_machines(double relative_range, BlindDraw& draw);
  void draw_target(const BlindConditions& conditions, BlindDraw& draw);
  void split_target(const BlindConfig& config, BlindDraw& draw);
  void draw_others(BlindDraw& draw);
  void apply(const BlindKind& kind, double scale, sim::grid::Grid& grid) const;
  std::vector<const BlindKind*> hidden_;
  std::vector<std::vector<sim::plant::Block>> blocks_;  ///< hidden blocks per kind
  sim::grid::Grid grid_;
  std::string name_;
  int plant_ = 0;
  std::vector<int> recorded_;
  bool controlled_ = false, transformed_ = false;
};

/// Varies every parameter except codes and limits by up to `relative_range`. Repeats this until the effect's
/// checks accept the values; after 200 rejected draws, the values stay unchanged.
void jitter(sim::plant::Block& block, double relative_range, BlindDraw& draw);

/// Changes every parameter of a machine except codes, up or down, by a relative amount in the range `wrong`.
/// Repeats this until the machine is physical. Returns false if none of 10,000 draws is physical.
bool mislead(sim::plant::Block& machine, std::pair<double, double> wrong, BlindDraw& draw);

/// Draws a fault at a bus other than the plant's.
BlindEvent draw_fault(const BlindWorld& world, BlindDraw& draw);
/// Draws a load step or the loss of another generator.
BlindEvent draw_frequency_event(const BlindWorld& world, BlindDraw& draw);

/// Simulates an event and returns V, theta, P, Q, speed and Ifd of the plants at the fine sampling rate; P
/// and Q on each machine's base.
sim::reference::ReferenceRun simulate_fine(const sim::grid::Grid& grid, const std::vector<int>& plants,
                                           const BlindEvent& event, const BlindConfig& config);
/// Returns the noise-free record of the instruments. Hidden measurement effects and the filter act at the
/// fine rate; then every n-th sample is taken. P and Q are on the base kRecordMva. If `other`, the second
/// plant of the run, is not null, P and Q include its power.
validate::record::Record measured(const sim::reference::ReferenceRun& fine, const sim::plant::Plant& plant,
                                  const BlindEvent& event, const Conditions& conditions, double frequency,
                                  std::uint64_t seed, const sim::plant::Plant* other = nullptr);
/// Standard deviations of white noise. `power`: for P and Q as a share of `mva`, and for Ifd [pu]; `voltage`:
/// for V [pu] and theta [rad]; `speed`: for the speed [pu].
struct RecordNoise {
  double power, mva, voltage, speed;
};
/// Adds noise to the record; without `channels`, also removes speed and Ifd.
void add_noise(validate::record::Record& record, const RecordNoise& noise, bool channels, BlindDraw& draw);

/// Size of a hidden effect: norm of the change of P and Q that the effect causes in all events. The unit is
/// the residual noise of a correct model. This noise consists of the noise of P and Q, and of the response of
/// plant and controls to the noise of V and theta.
class BlindSize {
 public:
  /// `plain`: records without the hidden effects; `tested`: the correct model of these records;
  /// `power_noise`: standard deviation of P and Q [pu on the records' base]; `voltage_noise`: that of V [pu]
  /// and theta [rad].
  BlindSize(const sim::plant::PlantUnderTest& tested, const std::vector<BlindEvent>& events,
            std::vector<validate::record::Record> plain, double power_noise, double voltage_noise);
  /// Returns the size before the refit; `with`: records with the hidden effect.
  [[nodiscard]] double visible(const std::vector<validate::record::Record>& with) const;
  /// Returns the size after a linear refit of the model's parameters and of each event's switching times and
  /// initial state. The parameters of the paths `but` are not refitted.
  [[nodiscard]] double left(const std::vector<validate::record::Record>& with,
                            std::span<const BlindPath> but = {}) const;

 private:
  [[nodiscard]] validate::playin::Response response(
      std::size_t event, const validate::record::Record& record,
      const std::vector<validate::playin::SensitivityParameter>& along) const;
  [[nodiscard]] Eigen::VectorXd residual(std::size_t event, const validate::record::Record& record) const;
  void add_columns(std::size_t event);
  /// Returns the number of sensitivity parameters of one event: its switching times and its initial state.
  [[nodiscard]] Eigen::Index own_columns(std::size_t event) const;
  /// Returns the index of an event's first row in columns_.
  [[nodiscard]] Eigen::Index first_row(std::size_t event) const;

  sim::plant::Plant plant_;
  sim::Conventions conventions_;
  std::vector<BlindEvent> events_;
  std::vector<validate::record::Record> plain_;
  std::vector<validate::event::FitEvent> prepared_;
  std::vector<validate::noise::EventNoise> noise_;  ///< noise of each event
  std::vector<Eigen::VectorXd> plain_residual_;     ///< [event][sample * 2 + channel] [pu]
  validate::noise::RowMatrix
      columns_;  ///< whitened sensitivities for the refit: [event, sample, channel][parameter]
};

}  // namespace swingbank::research::blind::cases
