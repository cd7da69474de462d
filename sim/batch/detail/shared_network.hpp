#pragma once
// Network solution for grids of many sources, I = (M + sum_k u_k w_k^T) E, with one matrix for all lanes. M
// is the grid's own matrix, stored densely or as sparse factors of the whole network. A few outer products
// per lane represent that lane's switching and machine parameters. A matrix per lane would not fit into the
// caches. The products of other lanes add zero to a lane, so its result is bitwise independent of them.
#include <algorithm>
#include <array>
#include <numeric>

#include "sim/batch/detail/bus_factors.hpp"
#include "sim/batch/detail/lane_traits.hpp"
#include "sim/batch/detail/matrix_rows.hpp"
#include "sim/batch/detail/switched_network.hpp"

namespace swingbank::sim::batch {

/// The shared matrix M and the updates of all lanes.
template <class T>
class SharedNetwork {
 public:
  /// Smallest number of sources for which a shared matrix is faster than a matrix per lane.
  static constexpr int kMany = 32;
  /// Returns the largest number of outer products that cost less than a separate matrix.
  static constexpr int most_products(std::size_t sources) { return static_cast<int>(sources / 2); }

  void assign(const InternalMatrix& own);
  /// Uses sparse factors of the network instead of the matrix.
  void assign(const BusFactors& factors, const std::vector<Feed>& plants);
  /// Returns true if the sparse factors cost less than `rows` rows of the matrix.
  static bool pays(const BusFactors& factors, std::size_t rows, std::size_t sources) {
    return 2 * (factors.entries() + 2 * factors.buses()) <= rows * sources;
  }
  [[nodiscard]] bool factored() const { return factors_.buses() > 0; }
  [[nodiscard]] const BusFactors& factors() const { return factors_; }
  /// Sets a lane's matrix: M + products, or a separate matrix.
  void set(int lane, const LowRank& products);
  void set(int lane, const InternalMatrix& matrix);
  /// Computes all currents; ir and ii have the size SharedRows::padded.
  void solve(const T* er, const T* ei, T* ir, T* ii);
  /// Computes all currents with the products of lane number `lane`. Every SIMD lane of er and ei must belong
  /// to that lane's event.
  void solve_of(int lane, const T* er, const T* ei, T* ir, T* ii);
  /// Returns true if a lane has a separate matrix.
  [[nodiscard]] bool whole(int lane) const { return ((whole_ >> lane) & 1U) != 0; }

 private:
  using Traits = LaneTraits<T>;
  static constexpr int kLanes = LaneTraits<T>::lanes;
  /// One outer product per lane.
  struct Product {
    std::vector<T> ur, ui, wr, wi;
  };
  void solve_own(const T* er, const T* ei, T* ir, T* ii);
  void correct(const T* er, const T* ei, T* ir, T* ii);
  void replace(const T* er, const T* ei, T* ir, T* ii) const;

  std::size_t sources_ = 0;
  SharedRows rows_;
  BusFactors factors_;        ///< replaces rows_ if not empty
  std::vector<Feed> plants_;  ///< buses in the order of `factors_`
  std::vector<T> vr_, vi_;    ///< scratch: currents into the buses, then their voltages
  std::vector<Product> products_;
  std::vector<T> sum_r_, sum_i_;  ///< scratch: w_k^T E
  std::array<int, kLanes> rank_{};
  int most_ = 0;          ///< maximum of rank_
  unsigned whole_ = 0;    ///< lanes with a separate matrix
  std::vector<T> g_, b_;  ///< matrices of the lanes in whole_; empty until the first use
};

template <class T>
void SharedNetwork<T>::assign(const InternalMatrix& own) {
  sources_ = own.grounded.size();
  std::vector<int> all(sources_);
  std::iota(all.begin(), all.end(), 0);
  rows_.assign(own, all);
}

template <class T>
void SharedNetwork<T>::assign(const BusFactors& factors, const std::vector<Feed>& plants) {
  sources_ = plants.size();
  factors_ = factors;
  plants_ = plants;
  for (Feed& plant : plants_) plant.bus = factors.place(plant.bus);
  for (auto* v : {&vr_, &vi_}) v->resize(factors.buses());
}

template <class T>
void SharedNetwork<T>::set(int lane, const LowRank& products) {
  whole_ &= ~(1U << lane);
  const std::size_t n = sources_;
  rank_[static_cast<std::size_t>(lane)] = products.rank;
  most_ = *std::ranges::max_element(rank_);
  while (static_cast<int>(products_.size()) < most_) {
    const std::vector<T> zeros(n, T(0.0));
    products_.push_back({zeros, zeros, zeros, zeros});
  }
  for (auto* v : {&sum_r_, &sum_i_}) v->resize(products_.size());
  for (std::size_t k = 0; k < products_.size(); ++k) {
    const bool has = static_cast<int>(k) < products.rank;
    const auto put = [&](std::vector<T>& to, const std::vector<double>& from) {
      for (std::size_t i = 0; i < n; ++i) Traits::set(to[i], lane, has ? from[k * n + i] : 0.0);
    };
    put(products_[k].ur, products.ur);
    put(products_[k].ui, products.ui);
    put(products_[k].wr, products.wr);
    put(products_[k].wi, products.wi);
  }
}

template <class T>
void SharedNetwork<T>::set(int lane, const InternalMatrix& matrix) {
  set(lane, LowRank{});
  whole_ |= 1U << lane;
  for (auto* v : {&g_, &b_}) v->resize(matrix.g.size(), T(0.0));
  for (std::size_t i = 0; i < matrix.g.size(); ++i) {
    Traits::set(g_[i], lane, matrix.g[i]);
    Traits::set(b_[i], lane, matrix.b[i]);
  }
}

template <class T>
inline void SharedNetwork<T>::solve(const T* er, const T* ei, T* ir, T* ii) {
  solve_own(er, ei, ir, ii);
  correct(er, ei, ir, ii);
  if (whole_ != 0) replace(er, ei, ir, ii);
}

template <class T>
inline void SharedNetwork<T>::solve_of(int lane, const T* er, const T* ei, T* ir, T* ii) {
  solve_own(er, ei, ir, ii);
  for (int k = 0; k < rank_[static_cast<std::size_t>(lane)]; ++k) {
    const Product& p = products_[static_cast<std::size_t>(k)];
    T sr(0.0), si(0.0);
    for (std::size_t j = 0; j < sources_; ++j) {
      const T wr(Traits::get(p.wr[j], lane)), wi(Traits::get(p.wi[j], lane));
      sr = sr + (wr * er[j] - wi * ei[j]);
      si = si + (wr * ei[j] + wi * er[j]);
    }
    for (std::size_t i = 0; i < sources_; ++i) {
      const T ur(Traits::get(p.ur[i], lane)), ui(Traits::get(p.ui[i], lane));
      ir[i] = ir[i] + (ur * sr - ui * si);
      ii[i] = ii[i] + (ur * si + ui * sr);
    }
  }
}

/// Computes M E, without the lanes' updates.
template <class T>
inline void SharedNetwork<T>::solve_own(const T* er, const T* ei, T* ir, T* ii) {
  if (!factored()) return rows_.times(er, ei, ir, ii);
  for (auto* v : {&vr_, &vi_}) std::ranges::fill(*v, T(0.0));
  for (std::size_t k = 0; k < plants_.size(); ++k) {
    const T g(plants_[k].source.real()), b(plants_[k].source.imag());
    T &real = vr_[static_cast<std::size_t>(plants_[k].bus)],
      &imaginary = vi_[static_cast<std::size_t>(plants_[k].bus)];
    real = real + g * er[k];
    real = real - b * ei[k];
    imaginary = imaginary + g * ei[k];
    imaginary = imaginary + b * er[k];
  }
  factors_.solve(vr_.data(), vi_.data());
  for (std::size_t k = 0; k < plants_.size(); ++k) {
    const T g(plants_[k].own.real()), b(plants_[k].own.imag());
    const T real = er[k] - vr_[static_cast<std::size_t>(plants_[k].bus)],
            imaginary = ei[k] - vi_[static_cast<std::size_t>(plants_[k].bus)];
    ir[k] = g * real - b * imaginary;
    ii[k] = g * imaginary + b * real;
  }
}

/// Adds sum_k u_k (w_k^T E). The sum is formed separately, so that a lane with fewer products than others
/// adds +0 for the missing ones.
template <class T>
inline void SharedNetwork<T>::correct(const T* er, const T* ei, T* ir, T* ii) {
  const std::size_t n = sources_;
  const auto most = static_cast<std::size_t>(most_);
  for (std::size_t k = 0; k < most; ++k) {
    const Product& p = products_[k];
    row_times(p.wr.data(), p.wi.data(), er, ei, static_cast<int>(n), sum_r_[k], sum_i_[k]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    T r(0.0), x(0.0);
    for (std::size_t k = 0; k < most; ++k) {
      const Product& p = products_[k];
      r = r + p.ur[i] * sum_r_[k];
      r = r - p.ui[i] * sum_i_[k];
      x = x + p.ur[i] * sum_i_[k];
      x = x + p.ui[i] * sum_r_[k];
    }
    ir[i] = ir[i] + r;
    ii[i] = ii[i] + x;
  }
}

/// Replaces the currents of lanes with a separate matrix.
template <class T>
inline void SharedNetwork<T>::replace(const T* er, const T* ei, T* ir, T* ii) const {
  const std::size_t n = sources_;
  const auto whole = Traits::mask(whole_);
  for (std::size_t i = 0; i < n; ++i) {
    T r, x;
    row_times(&g_[i * n], &b_[i * n], er, ei, static_cast<int>(n), r, x);
    ir[i] = select(whole, r, ir[i]);
    ii[i] = select(whole, x, ii[i]);
  }
}

}  // namespace swingbank::sim::batch
