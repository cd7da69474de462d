#pragma once
// The reduced equations of a grid after its first switching, for SUNDIALS CVODES and its forward
// sensitivities by difference quotients. Supports all plants except machines with nonlinear current; no
// modelled loads.
#include <cvodes/cvodes.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>

#include "sim/batch/batch.hpp"
#include "sim/batch/detail/internal_network.hpp"
#include "sim/plant/equations.hpp"

namespace swingbank::sim::test {

class ReducedSystem {
 public:
  ReducedSystem(const grid::Grid& grid, const network::Event& event, std::vector<batch::Seed> seeds)
      : grid_(grid),
        topology_(network::segments(event, grid.network).front().topology),
        seeds_(std::move(seeds)) {
    for (const batch::Seed& seed : seeds_)
      p.push_back(plant::parameter_value(grid_.plants[static_cast<std::size_t>(seed.plant)], seed.parameter));
  }
  ReducedSystem(const ReducedSystem&) = delete;  // network_ refers to grid_
  ReducedSystem& operator=(const ReducedSystem&) = delete;
  std::vector<double> p;  ///< seeded values, changed by CVODES

  /// Every plant's states at its operating point.
  [[nodiscard]] std::vector<double> start() {
    update();
    std::vector<double> y;
    for (const plant::Operating& o : at_) y.insert(y.end(), o.x.begin(), o.x.end());
    return y;
  }
  /// Index of a plant's first state.
  [[nodiscard]] std::size_t first(int plant) const {
    std::size_t states = 0;
    for (int i = 0; i < plant; ++i)
      states += static_cast<std::size_t>(
          plant::PlantEquations<double>(grid_.plants[static_cast<std::size_t>(i)]).states());
    return states;
  }
  void derivative(double t, const double* y, double* dy) {
    update();
    const std::size_t n = grid_.plants.size();
    std::vector<double> er(n), ei(n);
    std::vector<std::vector<double>> m(n);
    std::vector<plant::PlantEquations<double>> equations;
    std::vector<std::size_t> first;
    std::size_t states = 0;
    for (std::size_t i = 0; i < n; ++i) {
      equations.emplace_back(grid_.plants[i]);
      m[i].resize(static_cast<std::size_t>(equations[i].scratch()));
      first.push_back(states);
      equations[i].emf(at_[i].c.data(), y + states, m[i].data(), er[i], ei[i]);
      states += static_cast<std::size_t>(equations[i].states());
    }
    for (std::size_t i = 0; i < n; ++i) {
      Signals<double> s;
      for (std::size_t j = 0; j < n; ++j) {
        s.Ir += matrix_.g[i * n + j] * er[j] - matrix_.b[i * n + j] * ei[j];
        s.Ii += matrix_.g[i * n + j] * ei[j] + matrix_.b[i * n + j] * er[j];
      }
      s.Efd = at_[i].Efd;
      s.Tm = at_[i].Tm;
      s.t = t;
      equations[i].voltages(at_[i].c.data(), er[i], ei[i], s);
      equations[i].derivative(at_[i].c.data(), y + first[i], m[i].data(), s, dy + first[i]);
    }
  }

 private:
  void update() {
    if (used_ == p) return;
    used_ = p;
    for (std::size_t i = 0; i < seeds_.size(); ++i)
      plant::parameter_value(grid_.plants[static_cast<std::size_t>(seeds_[i].plant)], seeds_[i].parameter) =
          p[i];
    at_.clear();
    std::vector<double> r, x;
    for (const plant::Plant& each : grid_.plants) {
      at_.push_back(plant::operating_point(each, grid_.flow.voltage[static_cast<std::size_t>(each.bus)],
                                           grid_.network.base_mva, grid_.conventions));
      const double* z = plant::PlantEquations<double>(each).impedance(at_.back().c.data());
      r.push_back(z[0]);
      x.push_back(z[1]);
    }
    matrix_ = network_.matrix(topology_, r, x);
  }

  grid::Grid grid_;
  batch::InternalNetwork network_{grid_};  ///< stores the reduction, which depends on no parameter
  network::Topology topology_;
  std::vector<batch::Seed> seeds_;
  std::vector<plant::Operating> at_;
  batch::InternalMatrix matrix_;
  std::vector<double> used_;  ///< the parameters of `at_`
};

/// Sensitivities of the first `states` states of a plant, times each seed's scale: [seed][state][sample].
class CvodesSensitivities {
 public:
  CvodesSensitivities(ReducedSystem& system, std::vector<batch::Seed> seeds)
      : system_(system), seeds_(std::move(seeds)) {
    SUNContext_Create(nullptr, &context_);
    const auto start = system.start();
    const auto size = static_cast<sunindextype>(start.size());
    y_ = N_VNew_Serial(size, context_);
    std::copy(start.begin(), start.end(), N_VGetArrayPointer(y_));
    sensitivities_ = N_VCloneVectorArray(count(), y_);
    operating_sensitivities(size);
    cvode_ = CVodeCreate(CV_BDF, context_);
    matrix_ = SUNDenseMatrix(size, size, context_);
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    scales_ = system.p;
    for (double& s : scales_)
      if (s == 0.0) s = 1.0;
    require(CVodeInit(cvode_, rhs, 0.0, y_));
    require(CVodeSStolerances(cvode_, 1e-9, 1e-11));
    require(CVodeSetUserData(cvode_, &system));
    require(CVodeSetLinearSolver(cvode_, solver_, matrix_));
    require(CVodeSetMaxNumSteps(cvode_, 100000));
    require(CVodeSensInit1(cvode_, count(), CV_SIMULTANEOUS, nullptr, sensitivities_));
    require(CVodeSetSensParams(cvode_, system.p.data(), scales_.data(), nullptr));
    require(CVodeSensEEtolerances(cvode_));
    require(CVodeSetSensErrCon(cvode_, 1));
  }
  CvodesSensitivities(const CvodesSensitivities&) = delete;
  CvodesSensitivities& operator=(const CvodesSensitivities&) = delete;
  ~CvodesSensitivities() {
    N_VDestroyVectorArray(sensitivities_, count());
    N_VDestroy(y_);
    CVodeFree(&cvode_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    SUNContext_Free(&context_);
  }
  [[nodiscard]] std::vector<std::vector<std::vector<double>>> columns(int plant, std::size_t states,
                                                                      int samples, double rate) {
    std::vector<std::vector<std::vector<double>>> column(seeds_.size(),
                                                         std::vector<std::vector<double>>(states));
    const std::size_t first = system_.first(plant);
    for (int k = 0; k < samples; ++k) {
      realtype t = 0.0;
      if (k > 0) {
        require(CVode(cvode_, k / rate, y_, &t, CV_NORMAL));
        require(CVodeGetSens(cvode_, &t, sensitivities_));
      }
      for (std::size_t i = 0; i < seeds_.size(); ++i)
        for (std::size_t state = 0; state < states; ++state)
          column[i][state].push_back(N_VGetArrayPointer(sensitivities_[i])[first + state] * seeds_[i].scale);
    }
    return column;
  }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(seeds_.size()); }
  static void require(int flag) {
    if (flag < 0) throw std::runtime_error("CVODES failed with code " + std::to_string(flag));
  }
  static int rhs(realtype t, N_Vector y, N_Vector dy, void* user) {
    static_cast<ReducedSystem*>(user)->derivative(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    return 0;
  }
  /// Sensitivities of the operating point, by central differences.
  void operating_sensitivities(sunindextype size) {
    const auto nominal = system_.p;
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      const double h = 1e-5 * (nominal[i] == 0.0 ? 1.0 : nominal[i]);
      system_.p[i] += h;
      const auto up = system_.start();
      system_.p[i] -= 2 * h;
      const auto down = system_.start();
      system_.p = nominal;
      for (sunindextype k = 0; k < size; ++k) {
        const auto at = static_cast<std::size_t>(k);
        N_VGetArrayPointer(sensitivities_[i])[k] = (up[at] - down[at]) / (2 * h);
      }
    }
  }

  ReducedSystem& system_;
  std::vector<batch::Seed> seeds_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  N_Vector* sensitivities_ = nullptr;
  void* cvode_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  std::vector<double> scales_;
};

}  // namespace swingbank::sim::test
