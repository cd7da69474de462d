#pragma once
// Estimates without training: by the machine's closed form, alone or refined. They stand in the tables beside
// the networks, as what a person with the equations would do.
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "train/data/noise.hpp"

namespace swingbank::train::direct {

/// "closed-form": linear least squares, of smoothed signals where there is noise. "refined": from there the
/// most probable parameters; without noise, Levenberg-Marquardt on the fluxes alone is a start as well, and
/// channels count as if they had a noise of 0.01 %.
/// "curve-fit": least squares of P, Q, speed and field current with the voltage played in, from the effect's
/// standard parameters alone, kept in the box but not drawn to anything: what a program for deriving
/// parameters does that has no other start (the thesis compares with EPRI's PPPD).
/// "floor": no estimate but the truth, off by the root of the Bayesian Cramer-Rao bound, so that its squared
/// error is the least that any estimate of these noisy records has on average.
inline constexpr std::array<std::string_view, 4> kMethods = {"closed-form", "refined", "curve-fit", "floor"};
bool is_method(std::string_view name);

/// rows x parameters in raw units, inside the sampling box, for rows of the dataset in ascending order. The
/// records count whole and at full rate, whatever a network would see of them. `tell`: called with the number
/// of rows done. Throws InputError if the machine has no closed form, a channel that it needs is not
/// recorded, parameters of other effects vary, or a floor is asked for without noise.
std::vector<double> estimate(const mpi::store::Dataset& dataset, std::span<const std::uint64_t> rows,
                             std::string_view method, const data::NoiseRecipe& noise = {},
                             const std::function<void(std::size_t)>& tell = {});

}  // namespace swingbank::train::direct
