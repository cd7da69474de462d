#pragma once
// Estimates without training, by the machine's equations. The result tables list them beside the networks.
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "train/data/noise.hpp"

namespace swingbank::train::direct {

/// Methods:
/// - "closed-form": linear least squares, on smoothed signals if there is noise.
/// - "refined": maximum a posteriori estimate, started from the closed form. Without noise, a
/// Levenberg-Marquardt fit of the fluxes gives a further start, and channels are weighted as if they had
/// noise of 0.01 %; for a machine without flux states, the search for the maximum is omitted.
/// - "curve-fit": least squares of P, Q, speed and field current with played-in voltage, from the effect's
/// defaults only, bounded by the box but without a prior. It corresponds to programs such as EPRI's PPPD,
/// with which the thesis compares.
/// - "floor": the true value plus the square root of the Bayesian Cramer-Rao bound. Its mean squared error is
/// the lower bound for any estimate from these noisy records.
inline constexpr std::array<std::string_view, 4> kMethods = {"closed-form", "refined", "curve-fit", "floor"};
bool is_method(std::string_view name);

/// Returns estimates for rows of the dataset in ascending order: rows x parameters [raw units], inside the
/// sampling box except for "floor". Uses complete records at full rate, independent of the networks' input.
/// `report`: called with the number of finished rows. Throws InputError if the machine has no closed form
/// (closed-form, refined) or no likelihood (all methods except closed-form), a required channel is not
/// recorded, parameters of other effects vary, or the floor is requested without noise; Interrupted after a
/// stop signal.
std::vector<double> estimate(const mpi::store::Dataset& dataset, std::span<const std::uint64_t> rows,
                             std::string_view method, const data::NoiseRecipe& noise = {},
                             const std::function<void(std::size_t)>& report = {});

/// Returns maximum a posteriori estimates, searched from `starts`, rows x parameters [raw units]. A
/// search whose residuals are more than noise is repeated from further starts. Otherwise like `estimate`; the
/// level of `noise` must be above 0.
std::vector<double> estimate_from(const mpi::store::Dataset& dataset, std::span<const std::uint64_t> rows,
                                  std::span<const double> starts, const data::NoiseRecipe& noise,
                                  const std::function<void(std::size_t)>& report = {});

}  // namespace swingbank::train::direct
