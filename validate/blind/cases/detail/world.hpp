#pragma once
// The world of one blind case, which is drawn: grid, plants, controls and events. It gives the grid at any
// size of the hidden effects.
#include <array>
#include <optional>
#include <span>

#include "sim/grid/grid.hpp"
#include "sim/reference/reference.hpp"
#include "validate/blind/cases/case.hpp"
#include "validate/blind/cases/detail/conditions.hpp"
#include "validate/blind/cases/detail/random.hpp"
#include "validate/event/event.hpp"

namespace swingbank::validate::blind::cases {

inline constexpr double kRecordMva = 100.0;  ///< base of P_pu and Q_pu in blind records [MVA]

class BlindWorld {
 public:
  /// Draws grid, plant, true parameters and controls. Throws InputError where they do not fit one another.
  BlindWorld(const BlindConfig& config, const std::vector<const BlindKind*>& hidden, BlindDraw& draw);

  /// The grid with each hidden effect at its scale; nullopt leaves an effect out.
  [[nodiscard]] sim::grid::Grid grid(std::span<const std::optional<double>> scale) const;
  /// Grid without any hidden effect.
  [[nodiscard]] const sim::grid::Grid& plain() const { return grid_; }
  [[nodiscard]] int plant() const { return plant_; }
  [[nodiscard]] const std::string& grid_name() const { return name_; }
  [[nodiscard]] bool controlled() const { return controlled_; }
  [[nodiscard]] bool converter() const {
    return grid_.plants[static_cast<std::size_t>(plant_)].machine.effect->converter;
  }
  /// Indices of the plants whose P and Q are recorded together, that of plant() first.
  [[nodiscard]] const std::vector<int>& recorded() const { return recorded_; }
  /// Whether a transformer that the model knows stands before the point that is recorded.
  [[nodiscard]] bool transformed() const { return transformed_; }

 private:
  void draw_machines(double spread, BlindDraw& draw);
  void draw_target(const BlindConditions& conditions, BlindDraw& draw);
  void split_target(const BlindConfig& config, BlindDraw& draw);
  void draw_others(BlindDraw& draw);
  void apply(const BlindKind& kind, double scale, sim::grid::Grid& grid) const;
  std::vector<const BlindKind*> hidden_;
  std::vector<std::vector<sim::plant::Block>> blocks_;  ///< hidden ones, per kind
  sim::grid::Grid grid_;
  std::string name_;
  int plant_ = 0;
  std::vector<int> recorded_;
  bool controlled_ = false, transformed_ = false;
};

/// Every non-code parameter moved by up to `spread`, until the effect's own checks accept them.
void jitter(sim::plant::Block& block, double spread, BlindDraw& draw);

/// Moves every parameter of a machine by a share between `wrong`'s ends, up or down, until the machine is
/// physical. False: it was not in 10,000 draws.
bool mislead(sim::plant::Block& machine, std::pair<double, double> wrong, BlindDraw& draw);

BlindEvent draw_fault(const BlindWorld& world, BlindDraw& draw);
/// A load step or the loss of another generator.
BlindEvent draw_frequency_event(const BlindWorld& world, BlindDraw& draw);

/// The plants' own quantities of one event on the fine grid: V, theta, P, Q, speed, Ifd, P and Q on each
/// machine's base.
sim::reference::ReferenceRun simulate_fine(const sim::grid::Grid& grid, const std::vector<int>& plants,
                                           const BlindEvent& event, const BlindConfig& config);
/// The record that the instruments make of it, without noise: hidden measurement effects and the filter act
/// on the fine grid, and every n-th sample is taken. P and Q are on kRecordMva, and those of `other`, the
/// run's second plant, are in them if there is one.
record::Record measured(const sim::reference::ReferenceRun& fine, const sim::plant::Plant& plant,
                        const BlindEvent& event, const Conditions& conditions, double frequency,
                        std::uint64_t seed, const sim::plant::Plant* other = nullptr);
/// White noise of these standard deviations: `noise` of `mva` on P and Q, the rest as the record's columns.
struct RecordNoise {
  double power, mva, voltage, speed;
};
void add_noise(record::Record& record, const RecordNoise& noise, bool channels, BlindDraw& draw);

/// How large a difference between records is, for P and Q of all events, in units of the noise that the right
/// model leaves. This is the noise of P and Q, and that of V and theta as plant and controls answer to it,
/// with its slow part.
class BlindSize {
 public:
  /// `plain`: records without the hidden effects; `plant`: the model that explains them; standard deviations
  /// of P and Q, and of V and theta [pu on the records' base, rad].
  BlindSize(const sim::plant::PlantUnderTest& tested, const std::vector<BlindEvent>& events,
            std::vector<record::Record> plain, double power_noise, double voltage_noise);
  [[nodiscard]] double visible(const std::vector<record::Record>& with) const;
  /// Size of what is left after a linear refit of the machine's parameters, and of each event's instants and
  /// start.
  /// With `but`, these parameters of the path stay as they are.
  [[nodiscard]] double left(const std::vector<record::Record>& with,
                            std::span<const BlindPath> but = {}) const;

 private:
  [[nodiscard]] playin::Response answer(std::size_t event, const record::Record& record,
                                        const std::vector<playin::Direction>& along) const;
  [[nodiscard]] Eigen::VectorXd residual(std::size_t event, const record::Record& record) const;
  void add_columns(std::size_t event);
  /// Directions that belong to one event: its instants and its start.
  [[nodiscard]] Eigen::Index own_columns(std::size_t event) const;
  /// Rows of an event within those of all.
  [[nodiscard]] Eigen::Index first_row(std::size_t event) const;

  sim::plant::Plant plant_;
  sim::Conventions conventions_;
  std::vector<BlindEvent> events_;
  std::vector<record::Record> plain_;
  std::vector<event::FitEvent> prepared_;
  std::vector<event::EventNoise> noise_;         ///< of each event
  std::vector<Eigen::VectorXd> plain_residual_;  ///< [event][sample * 2 + channel] [pu]
  event::RowMatrix
      columns_;  ///< directions that a refit may use, whitened: [event, sample, channel][direction]
};

}  // namespace swingbank::validate::blind::cases
