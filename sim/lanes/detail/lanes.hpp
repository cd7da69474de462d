#pragma once
// The lanes kernel for one scalar type (double: one lane, Pack<N>: N lanes, FloatPack: sixteen). See
// batch.hpp for what it promises.
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "sim/core/float_ops.hpp"
#include "sim/lanes/detail/internal_network.hpp"
#include "sim/lanes/detail/lane_schedule.hpp"
#include "sim/lanes/detail/lane_traits.hpp"
#include "sim/lanes/detail/operating_state.hpp"
#include "sim/lanes/detail/shared_network.hpp"
#include "sim/lanes/detail/switched_network.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/load_equations.hpp"
#include "sim/plant/tableau.hpp"

namespace swingbank::sim::lanes {

template <class T>
class Lanes {
 public:
  static constexpr int kLanes = LaneTraits<T>::lanes;
  static constexpr int kWaiting =
      8 * kLanes;  ///< samples evaluated together: constants are spread once for all
  static constexpr int kRoom = kWaiting + 4 * kLanes;  ///< whole packs are stored and moved
  using Next = std::function<bool(Job&)>;
  using Done = std::function<void(const Job&, const Trajectory&)>;

  Lanes(const grid::Grid& grid, const BatchOptions& options);
  void run(const Next& next, const Done& done);

 private:
  using Traits = LaneTraits<T>;
  using Flat = typename Traits::Flat;
  using Real = typename Traits::Real;
  /// States are then carried as the sum of two, and lose nothing from step to step.
  static constexpr bool kCarries = std::is_same_v<Real, float>;
  /// Of dp54::kink in the error: 0.03 would bound what a kink leaves by the tolerance, this by ten times it.
  static constexpr double kKinkShare = 0.003;
  /// What a kink leaves shows at once, however soon it is gone: a state weighs at least this much there.
  static constexpr double kKinkWeight = 0.3;
  static constexpr std::size_t kFlats = 1 + Traits::directions;  ///< flats in one T
  struct PlantSlice {
    plant::PlantEquations<T> equations;
    int x, c, m;        ///< offsets of states, coefficients and scratch
    int watch = -1;     ///< of watched_, -1: none
    FarRows far{};      ///< what its control measures elsewhere
    bool rotor = true;  ///< whether its first state is a rotor's angle; else it is a converter
  };

  /// An exciter behind a stabiliser: whether Vs comes to its limits or leaves them is seen from stages in
  /// which it stays the same to the bit.
  struct Watch {
    int first, count;              ///< the exciter's states
    Flat start{}, last{};          ///< Vs at the step's start, at the last stage
    Flat rested{}, rested_next{};  ///< 1 where Vs rested before the step, before the next one
    Flat same{};                   ///< stages at which Vs was the last one's
  };

  struct LoadSlice {
    plant::LoadEquations<T> equations;
    int x, c;
  };

  /// A state that stands still while two coefficients are zero (State::moved_by; -1: only the first counts).
  struct Resting {
    int state, first, second;
  };

  /// A state whose weight a coefficient multiplies (State::weighed_by).
  struct Weighed {
    int state, coefficient;
  };

  /// Samples of one lane that fall into this step and have room.
  struct Due {
    int lane, count;
  };

  /// What the equations need besides the states. One set has a lane per event; the other, for recording, is
  /// one event's values in every lane, its lanes being consecutive samples.
  struct Constants {
    std::vector<T> c, g, b, efd, tm, dvref, dpref, on;  ///< on: 1, or 0 where the plant is tripped
    std::vector<T> far_g, far_b;                        ///< see InternalMatrix
    std::vector<T> vr, vi;   ///< voltages at nonlinear sources' own terminals: where the search begins
    T last_moment;           ///< largest time effects may see [s]
    std::vector<T> factors;  ///< of the slopes of what the search solves, lane by lane of another past
    unsigned factored = 0;   ///< lanes that have some
    unsigned fallen = 0;     ///< lanes whose voltages were sought from zero in this step
  };

  // one evaluation (equations.hpp)
  void emfs(Constants& k, const T* x);
  void current(const Constants& k, std::size_t plant, Signals<T>& s) const;
  void shared_current(std::size_t at, const Constants& k, std::size_t plant, Signals<T>& s) const;
  void inputs(const Constants& k, std::size_t plant, Signals<T>& s) const;
  void look_far(const Constants& k, const FarRows& rows, Signals<T>& s) const;
  void derivative(const T* x, T* dx);

  // sources whose current is no linear function of the voltage (algebra.hpp)
  void solve_algebra(Constants& k, const T* x);
  unsigned search_voltages(Constants& k, const T* x, unsigned open);
  void begin_search(Constants& k, unsigned lanes, double voltage) const;
  void source_emf(const Constants& k, const T* x, int source, const T& vr, const T& vi, T& er, T& ei);
  const T* source_impedance(const Constants& k, int source) const;
  const T* own_impedance(const Constants& k, int source) const;
  const T* ratio(const Constants& k, int source) const;
  void algebra_rest(Constants& k, const T* x, const T* steady);
  void algebra_slopes(const Constants& k, const T* x, T* a);
  Flat newton_step(Constants& k, const T* x, const T* steady, unsigned anew);

  // recording (record.hpp)
  void record_step(const T& h, unsigned accepted, const double* start, const double* tried);
  void interpolate(const T& h, const double* start, const double* tried);
  void dense(std::size_t state, const T& h, Flat* rows) const;
  /// States of the waiting samples: [pack][state][sample of the pack].
  static Real* waiting(LaneRun& run) { return reinterpret_cast<Real*>(run.waiting.data()); }
  static const Real* waiting(const LaneRun& run) { return reinterpret_cast<const Real*>(run.waiting.data()); }
  const T* waiting_pack(const LaneRun& run, int first, const std::vector<int>& states, T* room) const;
  void evaluate_pending(int lane, int count);
  void drop_waiting(LaneRun& run, int count);
  void spread_constants(int lane);
  void outputs(std::size_t row_plant, const T* x, LaneRun& run, int count);
  void hold(LaneRun& run, int until) const;
  /// Whether a lane's samples need the currents of all plants.
  [[nodiscard]] bool records_whole(int lane) const { return whole_record_ && !shared_.whole(lane); }
  T unwrapped(T angle, const T& squared, double last, int count) const;

  // the lanes' matrices (network.hpp)
  void share();
  void choose_state(int lane);
  const Terminals& set_matrix(int lane, const network::Topology& topology);
  const Terminals& set_shared(int lane, const network::Topology& topology);
  const InternalMatrix& own_matrix();
  std::optional<LowRank> few_products(int lane, const network::Topology& topology);
  void matrix_slopes(int lane, const InternalMatrix& matrix);

  // loading (load.hpp)
  void load(int lane);
  void build_slices();
  void reserve();
  template <class Value>
  void load_plant(int lane, std::size_t plant, const plant::OperatingOf<Value>& at);
  void load_seeded(int lane, const std::map<int, plant::Plant>& changed);
  void load_consumer(int lane, std::size_t load);
  void find_moving();
  void find_weights();
  void enter_segment(int lane);
  void fill_waiting(int lane);
  void record_steady_start(int lane);
  int samples_until(double t) const;
  void refill(int lane, const Next& next, const Done& done);
  void begin_record(LaneRun& run) const;
  void hand_over(int lane, Outcome outcome, const Done& done);

  // stepping (step.hpp)
  void evaluate_fresh();
  template <int Stage>
  void stage(const T& h);
  Flat scaled_error(const Flat& h) const;
  Flat kink_error(std::size_t state) const;
  Flat own_error(std::size_t state) const;
  Flat has_kink(const Watch& watch) const;
  Flat leaves_limit(std::size_t state) const;
  void watch_stage(Watch& watch, const T& vs);
  void commit(unsigned accepted);
  void clamp_states();
  T spread(const T* x) const;
  double spread_of_islands(int lane) const;
  void settle(unsigned accepted, const Next& next, const Done& done);

  const grid::Grid& grid_;
  BatchOptions options_;
  std::shared_ptr<OperatingState> own_;                 ///< of the grid itself
  std::vector<std::shared_ptr<OperatingState>> state_;  ///< per lane
  SharedNetwork<T> shared_;                             ///< where shares_
  std::optional<SwitchedNetwork> switched_;             ///< where shares_
  std::optional<InternalMatrix> own_matrix_;            ///< where it was asked for
  bool whole_record_ =
      false;  ///< where shares_: so many are recorded that all currents are less work than their rows
  Terminals terminals_;                    ///< of the segment a lane enters; where shares_
  std::vector<double> own_r_, own_x_;      ///< impedances of the grid's own machines; where shares_
  std::vector<SharedRows> recorded_rows_;  ///< per lane, of its own matrix; where shares_
  std::vector<PlantSlice> plants_;
  std::vector<LoadSlice> loads_;
  std::vector<Watch> watched_;
  std::vector<int> nonlinear_;            ///< sources: plants, then loads
  bool limited_ = false, timed_ = false;  ///< whether any state has limits, any effect reads the time
  bool shares_ = false;                   ///< many sources: not a matrix per lane
  std::vector<int> stopped_;              ///< states with limits at which they are held
  std::vector<int> bent_;                 ///< states of which any step may hold a kink (State::bends)
  std::vector<Resting> resting_;
  std::vector<Weighed> weighed_;
  bool weighs_ = false;                ///< whether a coefficient of weighed_ is above 1 in any lane
  std::vector<int> moving_;            ///< states that move in any lane
  std::vector<int> wanted_, sampled_;  ///< states the outputs need; of these the moving ones
  std::vector<char> needed_;           ///< per state: whether the outputs need it
  std::vector<std::pair<std::size_t, std::size_t>> spread_;  ///< coefficients they need: first, number
  std::vector<int> recorded_;
  std::vector<Channel> channels_;
  int n_ = 0, sources_ = 0, samples_ = 0, states_ = 0;
  int far_count_ = 0;           ///< rows of what controls measure elsewhere
  std::vector<double> weight_;  ///< per state, already divided by the tolerance

  Constants per_lane_, per_sample_;
  std::vector<T> m_, er_, ei_;   ///< scratch of one evaluation
  std::vector<T> ir_, ii_;       ///< likewise, where shares_
  Signals<T> signals_;           ///< likewise: zeroing one per plant would cost 25 packs
  std::vector<T> algebra_;       ///< scratch of newton_step
  std::vector<T> steady_;        ///< currents of the linear sources at the nonlinear ones
  T time_{}, start_{};           ///< of the evaluation, of the step, per lane [s]
  std::vector<T> y_, trial_;     ///< states
  std::vector<T> carry_, move_;  ///< where kCarries: what y_ does not hold, what a step adds to it
  std::vector<T> rest_;          ///< rotor angle of each plant at its operating point [rad]
  std::vector<T> k_[plant::dp54::kStages];
  std::vector<T> kept_, unused_;
  std::vector<LaneRun> lanes_;
  std::vector<Due> due_;
  std::vector<std::vector<double>> lane_r_, lane_x_;  ///< source impedances per lane
  std::vector<std::vector<char>> grounded_;           ///< per lane and source: bus held at V = 0
  std::vector<std::vector<double>> connected_;        ///< per lane and source: part that is connected
  unsigned active_ = 0, fresh_ = 0;  ///< lanes that run; lanes whose first stage must be evaluated anew
  unsigned tripped_ = 0;             ///< lanes in which a plant is tripped
  int islands_ = 1;                  ///< of the grid with nothing tripped
};

}  // namespace swingbank::sim::lanes

#include "sim/lanes/detail/algebra.hpp"
#include "sim/lanes/detail/equations.hpp"
#include "sim/lanes/detail/load.hpp"
#include "sim/lanes/detail/network.hpp"
#include "sim/lanes/detail/record.hpp"
#include "sim/lanes/detail/step.hpp"
