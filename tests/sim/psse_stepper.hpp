#pragma once
// Our equations integrated the way PSS/E integrates its own: x(t + h) = x(t) + h (3 f(t) - f(t - h))/2, and
// at a switching instant the mean of the derivatives before and after it (both read off the first samples
// after the trip in its records); some exciters take shorter steps within each. With it a difference between
// record and equations is one of modelling.
#include <vector>

#include "sim/solve/reference_system.hpp"

namespace swingbank::sim::test {

/// Places in the vector of all states of those that belong to exciters.
inline std::vector<std::size_t> exciter_states(const ReferencePlants& plants) {
  std::vector<std::size_t> places;
  for (const auto& unit : plants.units()) {
    if (!unit.plant) continue;
    auto place = static_cast<std::size_t>(unit.first) + unit.plant->machine.effect->states.size();
    for (const Block& block : unit.plant->controls)
      for (std::size_t i = 0; i < block.effect->states.size(); ++i, ++place)
        if (block.effect->slot == Slot::exciter) places.push_back(place);
  }
  return places;
}

/// Calls see(time, signals, states) of plant `plant` every h seconds until `end` [s], twice at the switching
/// instant, which is event's only one and a multiple of h. A fourth argument of `see`, if it takes one, is
/// the real and imaginary voltage of every bus [pu]. Exciters take `exciter_steps` steps within each, during
/// which everything outside them stands still.
template <class See>
void step_as_psse(const Grid& grid, const Event& event, std::size_t plant, double h, double end,
                  const See& see, int exciter_steps = 1) {
  const ReferencePlants plants(grid);
  const auto parts = segments(event, grid.network, plants.instants());
  if (parts.size() != 2) throw std::runtime_error("one switching instant is expected");
  const ReferenceSystem before(grid, plants, parts[0], 2 * end), after(grid, plants, parts[1], 2 * end);
  const auto states = static_cast<std::size_t>(plants.states());
  std::vector<double> y(static_cast<std::size_t>(before.size())), f(y), f_before(y), f_after(y);
  for (const auto& unit : plants.units())
    std::copy(unit.operating.x.begin(), unit.operating.x.end(), y.begin() + unit.first);
  for (std::size_t b = 0; b < grid.flow.voltage.size(); ++b) {
    y[states + 2 * b] = grid.flow.voltage[b].real();
    y[states + 2 * b + 1] = grid.flow.voltage[b].imag();
  }
  const ReferenceSystem* system = &before;
  const auto exciters = exciter_states(plants);
  std::vector<double> fine, fine_f, fine_before(y.size());
  // One step of the exciters' states; f: their derivatives at its start, the switching's mean included.
  const auto step_exciters = [&](double t) {
    fine = y;
    fine_f = f;
    for (int k = 0; k < exciter_steps; ++k) {
      if (k > 0) system->derivatives(t, fine.data(), fine_f.data());
      for (const std::size_t i : exciters)
        fine[i] += h / exciter_steps * (1.5 * fine_f[i] - 0.5 * fine_before[i]);
      (void)system->clamp_states(fine.data());
      fine_before = fine_f;
    }
  };
  const auto steps = std::lround(end / h), switching = std::lround(parts[1].start / h);
  const auto look = [&](double t, std::vector<double>& to) {
    system->solve_voltages(t, y.data());
    Complex current;
    const auto signals = system->signals(plant, t, y.data(), current);
    const double* x = y.data() + plants.units()[plant].first;
    if constexpr (requires { see(t, signals, x, y.data()); })
      see(t, signals, x, y.data() + states);
    else
      see(t, signals, x);
    system->derivatives(t, y.data(), to.data());
  };
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * h;
    look(t, f);
    if (k == switching) {
      system = &after;
      look(t, f_after);
      for (std::size_t i = 0; i < states; ++i) f[i] = 0.5 * (f[i] + f_after[i]);
    }
    step_exciters(t);
    for (std::size_t i = 0; i < states; ++i) y[i] += h * (1.5 * f[i] - 0.5 * f_before[i]);
    for (const std::size_t i : exciters) y[i] = fine[i];
    (void)system->clamp_states(y.data());
    f_before = f;
  }
}

}  // namespace swingbank::sim::test
