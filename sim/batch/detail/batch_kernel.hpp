#pragma once
// Batch kernel for one scalar type (double: one lane, Pack<N>: N lanes, FloatPack: sixteen). See
// batch.hpp for the interface.
#include <cmath>
#include <limits>

#include "sim/batch/detail/internal_network.hpp"
#include "sim/batch/detail/lane_schedule.hpp"
#include "sim/batch/detail/lane_traits.hpp"
#include "sim/batch/detail/operating_state.hpp"
#include "sim/batch/detail/shared_network.hpp"
#include "sim/batch/detail/switched_network.hpp"
#include "sim/core/float_ops.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/load_equations.hpp"
#include "sim/plant/tableau.hpp"

namespace swingbank::sim::batch {

/// Integrator for LaneTraits<T>::lanes events at once.
template <class T>
class BatchKernel {
 public:
  static constexpr int kLanes = LaneTraits<T>::lanes;
  static constexpr int kWaiting =
      8 * kLanes;  ///< samples evaluated together, so that constants are broadcast only once
  static constexpr int kBufferSamples = kWaiting + 4 * kLanes;  ///< buffer size [samples], whole packs
  using Next = std::function<bool(Job&)>;
  using Done = std::function<void(const Job&, const Trajectory&)>;

  BatchKernel(const grid::Grid& grid, const BatchOptions& options);
  void run(const Next& next, const Done& done);

 private:
  using Traits = LaneTraits<T>;
  using Real = typename Traits::Real;
  /// True in single precision: increments are added to the states with compensated summation.
  static constexpr bool kCarries = std::is_same_v<Real, float>;
  /// Factor of dp54::kink in the error estimate. 0.03 would bound the error of a kink by the tolerance; this
  /// value bounds it by ten times the tolerance.
  static constexpr double kKinkShare = 0.003;
  /// Minimum weight of a state in the kink error. It is needed because the record shows a kink error even if
  /// that error decays quickly.
  static constexpr double kKinkWeight = 0.3;
  struct PlantSlice {
    plant::PlantEquations<T> equations;
    int x, c, m;        ///< offsets of states, coefficients and scratch
    int watch = -1;     ///< index into watched_, -1: none
    FarRows far{};      ///< remote measurements of its controls
    bool rotor = true;  ///< true if its first state is a rotor angle; false for a converter
  };

  /// Detection of kinks in an exciter with a stabiliser. The stabiliser's output Vs has a kink where it
  /// reaches or leaves its limits. At a limit, successive stages have bitwise equal Vs.
  struct Watch {
    int first, count;           ///< first state of the exciter, number of its states
    T start{}, last{};          ///< Vs at the start of the step and at the latest stage
    T rested{}, rested_next{};  ///< 1 if the latest stage left Vs unchanged: previous step, this step
    T same{};                   ///< number of stages with Vs unchanged from the previous stage
  };

  struct LoadSlice {
    plant::LoadEquations<T> equations;
    int x, c;
  };

  /// A state that is constant while two coefficients are zero (State::moved_by; second = -1: only the first).
  struct Resting {
    int state, first, second;
  };

  /// A state whose weight is multiplied by a coefficient (State::weighed_by).
  struct Weighed {
    int state, coefficient;
  };

  /// Samples of one lane that lie in this step and fit into its buffer.
  struct Due {
    int lane, count;
  };

  /// Inputs of the equations other than the states. The set for integration has one event per lane. The set
  /// for recording has the values of one event in every lane; its lanes are consecutive samples.
  struct Constants {
    std::vector<T> c, g, b, efd, tm, dvref, dpref, on;  ///< on: 1, or 0 if the plant is tripped
    std::vector<T> far_g, far_b;                        ///< rows of remote measurements, see InternalMatrix
    std::vector<T> vr, vi;   ///< voltages at nonlinear sources: start of Newton's method [pu]
    T last_moment;           ///< upper bound of the time passed to effects [s]
    std::vector<T> factors;  ///< factors of the Newton matrix; each lane renews its own
    unsigned factored = 0;   ///< bit mask: lanes with valid factors
    unsigned fallen = 0;     ///< bit mask: lanes whose Newton's method restarted from V = 0 in this step
  };

  // one evaluation (equations.hpp)
  void emfs(Constants& k, const T* x);
  void current(const Constants& k, std::size_t plant, Signals<T>& s) const;
  void shared_current(std::size_t at, const Constants& k, std::size_t plant, Signals<T>& s) const;
  void inputs(const Constants& k, std::size_t plant, Signals<T>& s) const;
  void look_far(const Constants& k, const FarRows& rows, Signals<T>& s) const;
  void derivative(const T* x, T* dx);

  // sources whose current is a nonlinear function of the voltage (algebra.hpp)
  void solve_algebra(Constants& k, const T* x);
  unsigned search_voltages(Constants& k, const T* x, unsigned open);
  void begin_search(Constants& k, unsigned lanes, double voltage) const;
  void source_emf(const Constants& k, const T* x, int source, const T& vr, const T& vi, T& er, T& ei);
  const T* source_impedance(const Constants& k, int source) const;
  const T* own_impedance(const Constants& k, int source) const;
  const T* ratio(const Constants& k, int source) const;
  void algebra_rest(Constants& k, const T* x, const T* steady);
  void algebra_jacobian(const Constants& k, const T* x, T* a);
  T newton_step(Constants& k, const T* x, const T* steady, unsigned anew);

  // recording (record.hpp)
  void record_step(const T& h, unsigned accepted, const double* start, const double* tried);
  void interpolate(const T& h, const double* start, const double* tried);
  void dense(std::size_t state, const T& h, T* row) const;
  /// Returns the states of the buffered samples, [pack][state][sample of the pack].
  static Real* waiting(BatchRun& run) { return reinterpret_cast<Real*>(run.waiting.data()); }
  static const Real* waiting(const BatchRun& run) {
    return reinterpret_cast<const Real*>(run.waiting.data());
  }
  const T* waiting_pack(const BatchRun& run, int first, const std::vector<int>& states, T* buffer) const;
  void evaluate_pending(int lane, int count);
  void drop_waiting(BatchRun& run, int count);
  void broadcast_constants(int lane);
  void outputs(std::size_t row_plant, const T* x, BatchRun& run, int count);
  void repeat_last(BatchRun& run, int until) const;
  /// Returns true if the recording of a lane computes the currents of all plants.
  [[nodiscard]] bool records_whole(int lane) const { return whole_record_ && !shared_.whole(lane); }
  T unwrapped(T angle, const T& squared, double last, int count) const;

  // network matrices of the lanes (network.hpp)
  void share();
  void choose_state(int lane);
  const Terminals& set_matrix(int lane, const network::Topology& topology);
  const Terminals& set_shared(int lane, const network::Topology& topology);
  const InternalMatrix& own_matrix();
  std::optional<LowRank> few_products(int lane, const network::Topology& topology);

  // loading (load.hpp)
  void load(int lane);
  void build_slices();
  void reserve();
  void load_plant(int lane, std::size_t plant, const plant::Operating& at);
  void load_consumer(int lane, std::size_t load);
  void set_source(int lane, const plant::Operating& at, int c, int x, const double* z, std::size_t source);
  void find_moving();
  void find_weights();
  void enter_segment(int lane);
  void fill_waiting(int lane);
  void record_steady_start(int lane);
  int samples_until(double t) const;
  void refill(int lane, const Next& next, const Done& done);
  void begin_record(BatchRun& run) const;
  void hand_over(int lane, Outcome outcome, const Done& done);

  // stepping (step.hpp)
  void evaluate_fresh();
  template <int Stage>
  void stage(const T& h);
  T scaled_error(const T& h) const;
  T kink_error(std::size_t state) const;
  T own_error(std::size_t state) const;
  T has_kink(const Watch& watch) const;
  T leaves_limit(std::size_t state) const;
  void watch_stage(Watch& watch, const T& vs);
  void commit(unsigned accepted);
  void clamp_states();
  T angle_spread(const T* x) const;
  double angle_spread_within_islands(int lane) const;
  void settle(unsigned accepted, const Next& next, const Done& done);

  const grid::Grid& grid_;
  BatchOptions options_;
  std::shared_ptr<OperatingState> own_;                 ///< operating point of the grid itself
  std::vector<std::shared_ptr<OperatingState>> state_;  ///< operating point per lane
  SharedNetwork<T> shared_;                             ///< used if shares_
  std::optional<SwitchedNetwork> switched_;             ///< used if shares_
  std::optional<InternalMatrix> own_matrix_;            ///< computed on demand
  bool whole_record_ = false;          ///< if shares_: true if all currents cost less than the recorded rows
  Terminals terminals_;                ///< if shares_: connection status in the segment that a lane enters
  std::vector<double> own_r_, own_x_;  ///< if shares_: machines' impedances with the grid's parameters [pu]
  std::vector<SharedRows> recorded_rows_;  ///< if shares_: rows of the recorded plants, per lane
  std::vector<PlantSlice> plants_;
  std::vector<LoadSlice> loads_;
  std::vector<Watch> watched_;
  std::vector<int> nonlinear_;            ///< nonlinear sources: plants, then loads
  bool limited_ = false, timed_ = false;  ///< true if any plant's state has limits; if any plant has controls
  bool shares_ = false;                   ///< true if the lanes share one matrix (grids of many sources)
  std::vector<int> stopped_;              ///< states with limits
  std::vector<int> kinked_;               ///< states with a kink error estimate in every step (State::bends)
  std::vector<Resting> resting_;
  std::vector<Weighed> weighed_;
  bool weighs_ = false;                ///< true if a coefficient of weighed_ exceeds 1 in any lane
  std::vector<int> moving_;            ///< states that are not constant in some lane
  std::vector<int> wanted_, sampled_;  ///< states that the outputs need; those of them that are not constant
  std::vector<char> needed_;           ///< per state: 1 if the outputs need it
  std::vector<std::pair<std::size_t, std::size_t>>
      broadcast_;  ///< coefficients that the outputs need: first index, number
  std::vector<int> recorded_;
  std::vector<Channel> channels_;
  int n_ = 0, sources_ = 0, samples_ = 0, states_ = 0;
  int far_count_ = 0;           ///< number of rows of remote measurements
  std::vector<double> weight_;  ///< weight per state, divided by the tolerance

  Constants per_lane_, per_sample_;
  std::vector<T> m_, er_, ei_;   ///< scratch of one evaluation
  std::vector<T> ir_, ii_;       ///< scratch, if shares_
  Signals<T> signals_;           ///< scratch shared by all plants, because a new object would zero 38 packs
  std::vector<T> algebra_;       ///< scratch of newton_step
  std::vector<T> steady_;        ///< currents that the linear sources cause at the nonlinear sources
  T time_{}, start_{};           ///< time of the evaluation, start of the step [s]
  std::vector<T> y_, trial_;     ///< states
  std::vector<T> carry_, move_;  ///< if kCarries: rounding error of y_, increment of a step
  std::vector<T> rest_;          ///< initial rotor angle per plant [rad]
  std::vector<T> k_[plant::dp54::kStages];
  std::vector<T> kept_, unused_;
  std::vector<BatchRun> lanes_;
  std::vector<Due> due_;
  std::vector<std::vector<double>> lane_r_, lane_x_;  ///< source impedances per lane
  std::vector<std::vector<char>> grounded_;           ///< per lane and source: 1 if its bus has V = 0
  std::vector<std::vector<double>> connected_;        ///< per lane and source: connected fraction
  unsigned active_ = 0, fresh_ = 0;  ///< bit masks: running lanes; lanes whose first stage needs evaluation
  unsigned tripped_ = 0;             ///< bit mask: lanes with a tripped plant
  int islands_ = 1;                  ///< number of islands of the unswitched grid
};

}  // namespace swingbank::sim::batch

#include "sim/batch/detail/algebra.hpp"
#include "sim/batch/detail/equations.hpp"
#include "sim/batch/detail/load.hpp"
#include "sim/batch/detail/network.hpp"
#include "sim/batch/detail/record.hpp"
#include "sim/batch/detail/step.hpp"
