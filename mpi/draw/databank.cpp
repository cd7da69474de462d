#include "mpi/draw/databank.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

constexpr std::uint64_t kBetweenLooks = 1024;  ///< draws between two looks for a signal

std::string reasons(const Databank& bank) {
  std::string text = fmt::format("{} too close", bank.too_close);
  for (const auto& [why, count] : bank.refused) text += fmt::format(", {} {}", count, why);
  return text;
}

}  // namespace

Databank draw_databank(const DatasetConfig& config, const sim::plant::Plant& base, std::uint64_t points) {
  BoxedPlant candidate(config, base);
  Databank bank;
  bank.dimensions = config.box.size();
  bank.values.reserve(points * bank.dimensions);
  Neighbours neighbours = make_neighbours(config);
  std::vector<double> x(bank.dimensions), measured(bank.dimensions);
  const auto patience =
      static_cast<std::uint64_t>(config.databank.candidates_per_point * static_cast<double>(points)) + 1000;
  std::uint64_t admissible = 0;
  while (bank.points() < points && !(bank.draws % kBetweenLooks == 0 && stop_asked())) {
    // A policy that hardly any draw can meet must not run for ever either.
    if (admissible > patience || bank.draws > 1000 * patience)
      throw InputError({fmt::format("databank reached {} of {} points", bank.points(), points),
                        config.file.string(), fmt::format("{} draws: {}", bank.draws, reasons(bank)),
                        "ask for fewer draws, a smaller databank.distance or another databank.scale, or "
                        "raise databank.candidates_per_point"});
    Random random(config.seed, Stream::databank, bank.draws++);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Box& b = config.box[i];
      const double u = b.sampled() ? random.uniform() : 0.0;
      x[i] = b.low + (b.high - b.low) * u;
      measured[i] = config.databank.scaled ? u : x[i];
    }
    candidate.set(x.data());
    if (const std::string why = objection(config, candidate.plant()); !why.empty()) {
      ++bank.refused[why];
      continue;
    }
    ++admissible;
    if (config.databank.distance > 0) {
      if (neighbours.near(measured.data())) {
        ++bank.too_close;
        continue;
      }
      neighbours.add(measured.data());
    }
    bank.values.insert(bank.values.end(), x.begin(), x.end());
  }
  return bank;
}

}  // namespace swingbank::mpi::draw
