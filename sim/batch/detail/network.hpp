#pragma once
// Batch kernel: network matrices. Grids of few sources have a matrix per lane; grids of many sources have one
// for all lanes and a low-rank update per lane.
#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

/// Decides whether the lanes share the grid's own matrix, and sets it up. The lanes share it in grids of many
/// sources, with two exceptions. With nonlinear sources Newton's method reads the lanes' matrices. A single
/// lane has nothing to share.
template <class T>
void BatchKernel<T>::share() {
  shares_ = kLanes > 1 && nonlinear_.empty() && n_ >= SharedNetwork<T>::kMany;
  if (!shares_) return;
  const auto n = static_cast<std::size_t>(n_);
  for (std::size_t i = 0; i < n; ++i) {
    const double* z =
        &own_->plants[i].c[static_cast<std::size_t>(grid_.plants[i].machine.effect->coefficients)];
    own_r_.push_back(z[plant::joint_r]);
    own_x_.push_back(z[plant::joint_x]);
  }
  switched_.emplace(grid_, own_r_, own_x_);
  BusFactors factors;
  const bool factored = switched_->sound() && factors.factor(switched_->closed());
  if (factored && SharedNetwork<T>::pays(factors, n, n))
    shared_.assign(factors, switched_->plants());
  else
    shared_.assign(own_matrix());
  whole_record_ = shared_.factored() && SharedNetwork<T>::pays(factors, recorded_.size(), n);
  recorded_rows_.resize(kLanes);
  const std::size_t rows = SharedRows::padded(std::max(n, recorded_.size()));
  for (auto* v : {&ir_, &ii_}) v->assign(rows, T(0.0));
}

/// Returns the matrix of the unswitched grid. Its size is quadratic and its cost cubic in the number of
/// sources. It is therefore computed only in two cases: without sparse factors, or for a switching that
/// SwitchedNetwork cannot represent, such as the trip of a generator.
template <class T>
const InternalMatrix& BatchKernel<T>::own_matrix() {
  if (!own_matrix_) own_matrix_ = own_->network.matrix({}, own_r_, own_x_);
  return *own_matrix_;
}

/// Sets a lane's matrix for a topology. Returns the connection status of its sources.
template <class T>
const Terminals& BatchKernel<T>::set_matrix(int lane, const network::Topology& topology) {
  if (shares_) return set_shared(lane, topology);
  const auto l = static_cast<std::size_t>(lane);
  const InternalMatrix& matrix = state_[l]->network.matrix(topology, lane_r_[l], lane_x_[l]);
  for (std::size_t i = 0; i < matrix.g.size(); ++i) {
    Traits::set(per_lane_.g[i], lane, matrix.g[i]);
    Traits::set(per_lane_.b[i], lane, matrix.b[i]);
  }
  for (std::size_t i = 0; i < matrix.far_g.size(); ++i) {
    Traits::set(per_lane_.far_g[i], lane, matrix.far_g[i]);
    Traits::set(per_lane_.far_b[i], lane, matrix.far_b[i]);
  }
  return matrix;
}

template <class T>
const Terminals& BatchKernel<T>::set_shared(int lane, const network::Topology& topology) {
  const auto l = static_cast<std::size_t>(lane);
  if (const auto products = few_products(lane, topology)) {
    shared_.set(lane, *products);
    if (!whole_record_ && shared_.factored())
      recorded_rows_[l].assign(
          plants_.size(), recorded_, [this](int k) { return switched_->row(k); }, *products);
    else if (!whole_record_)
      recorded_rows_[l].assign(own_matrix(), recorded_, *products);
    return terminals_;
  }
  const InternalMatrix& matrix = state_[l]->network.matrix(topology, lane_r_[l], lane_x_[l]);
  shared_.set(lane, matrix);
  recorded_rows_[l].assign(matrix, recorded_);
  return matrix;
}

/// Returns the low-rank update for the lane's topology and machines, and sets terminals_. Returns none if it
/// needs too many products, for example at another operating point, where every load changes.
template <class T>
std::optional<LowRank> BatchKernel<T>::few_products(int lane, const network::Topology& topology) {
  const auto l = static_cast<std::size_t>(lane);
  if (state_[l] != own_) return {};
  std::vector<ImpedanceChange> changes;
  for (std::size_t i = 0; i < plants_.size(); ++i)
    if (lane_r_[l][i] != own_r_[i] || lane_x_[l][i] != own_x_[i])
      changes.push_back({static_cast<int>(i), {lane_r_[l][i] - own_r_[i], lane_x_[l][i] - own_x_[i]}});
  const int most = SharedNetwork<T>::most_products(plants_.size()) - static_cast<int>(changes.size());
  if (most < 0) return {};
  auto products = switched_->change(topology, most);
  if (products) {
    terminals_ = {std::vector<char>(plants_.size(), 0), std::vector<char>(plants_.size(), 0),
                  std::vector<double>(plants_.size(), 1.0)};
    const auto grounded = network::grounded_buses(grid_.network, topology);
    for (std::size_t i = 0; i < plants_.size(); ++i)
      terminals_.grounded[i] = std::ranges::count(grounded, grid_.plants[i].bus) > 0;
  } else {
    const InternalMatrix& own = own_matrix();
    const InternalMatrix& matrix = own_->network.matrix(topology, own_r_, own_x_);
    terminals_ = matrix;
    products = difference(matrix, own, most);
  }
  if (!products || changes.empty()) return products;
  if (shared_.factored())
    add_impedances(
        *products,
        {[this](int k) { return switched_->row(k); }, [this](int k) { return switched_->column(k); }},
        changes);
  else
    add_impedances(*products, own_matrix(), changes);
  return products;
}

}  // namespace swingbank::sim::batch
