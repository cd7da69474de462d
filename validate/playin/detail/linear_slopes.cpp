// Slopes of a driven plant's answer from the plant as it is linear about the ends of each step.
#include "validate/playin/detail/linear_slopes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/stop_signal.hpp"

namespace swingbank::validate::playin {
namespace {

using Kind = Direction::Kind;
using sim::P8;

constexpr double kNodeMove = 1e-6;  ///< of a difference, relative to 1 + |state|
constexpr std::size_t kBase = 7;    ///< the lane of a pack that nothing moves
constexpr double kAtLimit = 1e-9;   ///< relative to 1 + |state|
constexpr auto kLanes = std::size_t(P8::lanes);

/// Rows of numbers, each a whole number of packs.
class Rows {
 public:
  Rows(std::size_t rows, std::size_t columns)
      : packs_((columns + kLanes - 1) / kLanes), all_(rows * packs_, P8(0.0)) {}
  P8* row(std::size_t i) { return all_.data() + i * packs_; }
  [[nodiscard]] const P8* row(std::size_t i) const { return all_.data() + i * packs_; }
  double& at(std::size_t i, std::size_t j) { return reinterpret_cast<double*>(row(i))[j]; }
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return row(i)[j / kLanes][int(j % kLanes)]; }
  void clear(std::size_t i) { std::fill_n(row(i), packs_, P8(0.0)); }

 private:
  std::size_t packs_;
  std::vector<P8> all_;
};

/// to += factor * from
void add(P8* to, double factor, const P8* from, std::size_t packs) {
  if (factor == 0.0) return;
  for (std::size_t p = 0; p < packs; ++p) to[p] = to[p] + P8(factor) * from[p];
}

/// The plant about a node: x' = A x + B, y = C x + D, by states and by directions.
struct Linear {
  Linear(std::size_t n, std::size_t m, std::size_t outputs)
      : A(n, n), B(n, m), C(outputs, n), D(outputs, m), held(n, 0) {}
  Rows A, B, C, D;
  std::vector<char> held;  ///< states that stand at a limit; their slopes are the limit's
};

class LinearSlopes {
 public:
  LinearSlopes(const Drive& run, std::span<const Direction> directions, const Trace& trace, Response& answer)
      : run_(run),
        directions_(directions),
        trace_(trace),
        answer_(answer),
        n_(trace.x.size() / trace.nodes.size()),
        m_(directions.size()),
        S_(n_, m_),
        limits_(n_, m_),
        shown_(run.linear_slopes.size()),
        before_(n_, m_, shown_),
        now_(n_, m_, shown_),
        left_(n_, n_),
        right_(n_, m_),
        guard_(2, std::max(n_, m_)) {
    start();
    begin_.assign(m_, -std::numeric_limits<double>::infinity());
    for (std::size_t d = 0; d < m_; ++d)
      if (const PiecewiseLinear* input = input_of(directions[d]))
        begin_[d] = input->hats()[static_cast<std::size_t>(std::max(0, directions[d].index - 1))];
    x_.resize(n_);
    dx_.resize(n_);
    factors_.resize(n_);
    more_factors_.resize(n_);
    sign_.resize(n_);
    outward_.resize(n_);
    later_.resize(m_);
  }

  bool run() {
    answer_.slopes.resize(m_);
    for (auto& slope : answer_.slopes)
      for (const Output o : run_.linear_slopes)
        slope.value[static_cast<int>(o)].reserve(run_.record->t.size());
    for (std::size_t k = 0; k < trace_.nodes.size(); ++k) {
      interruption_point();
      const Trace::Node& node = trace_.nodes[k];
      std::swap(before_, now_);
      look_at(std::min(node.t, node.side.last_moment));
      linearise(k);
      if (node.kind == Trace::Node::Kind::after)
        cross(k);
      else if (k > 0 && node.t > trace_.nodes[k - 1].t)
        step(node.t - trace_.nodes[k - 1].t);
      for (std::size_t i = 0; i < n_; ++i)
        if (now_.held[i]) std::copy_n(limits_.row(i), packs(), S_.row(i));
      if (node.kind == Trace::Node::Kind::sample) record();
    }
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t d = 0; d < m_; ++d)
        if (!std::isfinite(S_.at(i, d))) return false;
    return true;
  }

 private:
  /// Eight copies of the plant, seven of them moved each in its own way.
  struct Pack {
    DrivenEquations<P8> equations;
    P8 per_move;  ///< 1 / what the lane is moved by; of a state its sign is not in it
  };
  [[nodiscard]] std::size_t packs() const { return (active_ + kLanes - 1) / kLanes; }
  /// Directions that follow one another in the moves and among all directions.
  struct Run {
    std::size_t first, length;
  };
  /// Inputs that have begun by t, and how high they stand.
  void look_at(double t) {
    for (std::size_t d = m_; d > active_; --d)
      if (begin_[d - 1] <= t) active_ = d;
    if (!has_torque_ && !has_field_) return;
    for (std::size_t d = 0; d < active_; ++d)
      if (const PiecewiseLinear* input = input_of(directions_[d]))
        heights_[d] =
            directions_[d].scale * hat(input->hats(), static_cast<std::size_t>(directions_[d].index), t);
  }
  [[nodiscard]] const PiecewiseLinear* input_of(const Direction& d) const {
    return d.kind == Kind::torque ? &run_.torque : d.kind == Kind::field ? &run_.field : nullptr;
  }
  static bool moves_coefficients(const Direction& d) {
    return d.kind == Kind::parameter || d.kind == Kind::P || d.kind == Kind::Q;
  }

  /// Slopes of the start, and the moved copies: by states, by directions that are in the coefficients, by
  /// torque and field voltage.
  void start() {
    std::vector<std::vector<double>> c;
    std::vector<double> Efd, Tm;
    sim::plant::OperatingOf<P8> at;
    for (std::size_t first = 0; first < m_; first += sim::kDirections) {
      const auto some = directions_.subspan(first, std::min<std::size_t>(sim::kDirections, m_ - first));
      if (first > 0 && std::ranges::all_of(some, [&](const Direction& d) { return input_of(d); })) continue;
      const DrivenEquations<sim::D8> seeded(run_, some);
      if (first == 0) {
        for (const auto& value : seeded.c) at.c.emplace_back(value.a);
        at.Efd = P8(seeded.Efd.a);
        at.Tm = P8(seeded.Tm.a);
      }
      for (std::size_t d = 0; d < some.size(); ++d) {
        for (std::size_t i = 0; i < n_; ++i) S_.at(i, first + d) = seeded.x0[i].d[d];
        if (!moves_coefficients(some[d])) continue;
        ++seeded_;
        if (!runs_.empty() && runs_.back().first + runs_.back().length == first + d)
          ++runs_.back().length;
        else
          runs_.push_back({first + d, 1});
        auto& own = c.emplace_back();
        for (const auto& value : seeded.c) own.push_back(value.d[d]);
        Efd.push_back(seeded.Efd.d[d]);
        Tm.push_back(seeded.Tm.d[d]);
      }
    }
    for (const Direction& d : directions_) {
      has_torque_ = has_torque_ || d.kind == Kind::torque;
      has_field_ = has_field_ || d.kind == Kind::field;
    }
    const std::size_t inputs = n_ + seeded_;
    const std::size_t moves = inputs + (has_torque_ ? 1 : 0) + (has_field_ ? 1 : 0);
    for (std::size_t first = 0; first < moves; first += kBase) {
      Pack pack{{run_, {}, at}, P8(1 / kNodeMove)};
      for (std::size_t lane = 0; lane < kBase && first + lane < moves; ++lane) {
        const std::size_t move = first + lane;
        const int l = static_cast<int>(lane);
        if (move >= inputs) {
          (has_torque_ && move == inputs ? pack.equations.more_torque : pack.equations.more_field)
              .set(l, kNodeMove);
        } else if (move >= n_) {
          const std::size_t d = move - n_;
          for (std::size_t i = 0; i < at.c.size(); ++i)
            pack.equations.c[i].set(l, at.c[i][0] + kNodeMove * c[d][i]);
          pack.equations.Efd.set(l, at.Efd[0] + kNodeMove * Efd[d]);
          pack.equations.Tm.set(l, at.Tm[0] + kNodeMove * Tm[d]);
        }
      }
      packs_.push_back(std::move(pack));
    }
    moves_ = kBase * packs_.size() + 1;
    slopes_.resize((2 * n_ + shown_ + 1) * moves_);
    moved_guards_.assign(static_cast<std::size_t>(packs_.front().equations.of_plant().guards()), P8(0.0));
    heights_.resize(m_);
  }

  /// Finds the states at their limits, and on which side of them the others may be moved.
  void find_limits(const double* x, const double* dx) {
    std::ranges::fill(sign_, 1.0);
    std::ranges::fill(now_.held, 0);
    any_held_ = false;
    const auto& equations = packs_.front().equations;
    if (!equations.of_plant().limited()) return;
    constexpr int kUp = 0, kDown = 1;
    for (std::size_t i = 0; i < n_; ++i) {
      const double move = kNodeMove * (1 + std::abs(x[i]));
      x_[i] = P8(x[i]);
      x_[i].set(kUp, x[i] + move);
      x_[i].set(kDown, x[i] - move);
    }
    P8 moved(0.0);
    equations.of_plant().clamp_states(equations.c.data(), x_.data(), moved);
    for (std::size_t i = 0; i < n_; ++i) {
      const double scale = 1 + std::abs(x[i]);
      const double up = (x_[i][kUp] - x[i]) / scale, down = (x[i] - x_[i][kDown]) / scale;
      const bool high = up < kAtLimit, low = down < kAtLimit;
      sign_[i] = low || (!high && up < kNodeMove * (1 - 1e-3)) ? -1.0 : 1.0;
      if (!(high || low) || dx[i] != 0.0) continue;
      now_.held[i] = 1;
      any_held_ = true;
      outward_[i] = (high ? 1.0 : -1.0) * scale;
    }
  }
  /// Puts the states that are held at the limit of each lane.
  void hold(const Pack& pack, const double* x) {
    for (std::size_t i = 0; i < n_; ++i) x_[i] = P8(now_.held[i] ? x[i] + outward_[i] : x[i]);
    P8 moved(0.0);
    pack.equations.of_plant().clamp_states(pack.equations.c.data(), x_.data(), moved);
    for (std::size_t i = 0; i < n_; ++i)
      if (!now_.held[i]) x_[i] = P8(x[i]);
  }
  void linearise(std::size_t k) {
    const Trace::Node& node = trace_.nodes[k];
    const double* x = trace_.x.data() + k * n_;
    find_limits(x, trace_.dx.data() + k * n_);
    for (std::size_t i = 0; i < n_; ++i) limits_.clear(i);
    packs_.front().equations.side = node.side;
    const Complex v = packs_.front().equations.voltage(node.t);
    for (std::size_t p = 0; p < packs_.size(); ++p) {
      Pack& pack = packs_[p];
      if (any_held_)
        hold(pack, x);
      else
        for (std::size_t i = 0; i < n_; ++i) x_[i] = P8(x[i]);
      P8 per_move = pack.per_move;
      for (std::size_t lane = 0; lane < kBase && p * kBase + lane < n_; ++lane) {
        const std::size_t i = p * kBase + lane;
        if (now_.held[i]) continue;
        const double move = sign_[i] * kNodeMove * (1 + std::abs(x[i]));
        x_[i].set(static_cast<int>(lane), x[i] + move);
        per_move.set(static_cast<int>(lane), 1 / (x_[i][static_cast<int>(lane)] - x[i]));
      }
      pack.equations.side = node.side;
      pack.equations.evaluate_at(P8(v.real()), P8(v.imag()), node.t, x_.data(), dx_.data());
      const auto y = pack.equations.outputs(x_.data());
      for (std::size_t i = 0; i < n_; ++i) keep(p, dx_[i], per_move, i);
      for (std::size_t o = 0; o < shown_; ++o)
        keep(p, y[static_cast<std::size_t>(run_.linear_slopes[o])], per_move, n_ + o);
      if (node.passed.guard >= 0) {
        const auto& equations = pack.equations;
        equations.of_plant().guard(equations.c.data(), x_.data(), equations.signals, moved_guards_.data());
        keep(p, moved_guards_[static_cast<std::size_t>(node.passed.guard)], per_move, 2 * n_ + shown_);
      }
      if (!any_held_) continue;
      for (std::size_t i = 0; i < n_; ++i)
        if (now_.held[i]) keep(p, x_[i], per_move, n_ + shown_ + i);
    }
    if (node.passed.guard >= 0) take(2 * n_ + shown_, guard_.row(0), guard_.row(1));
    if (node.passed.guard >= 0 || (k > 0 && trace_.nodes[k - 1].passed.guard >= 0)) {
      // a copy may have been moved to the other side of the jump
      now_.A = before_.A;
      now_.B = before_.B;
    } else {
      for (std::size_t i = 0; i < n_; ++i) take(i, now_.A.row(i), now_.B.row(i));
    }
    for (std::size_t o = 0; o < shown_; ++o) take(n_ + o, now_.C.row(o), now_.D.row(o));
    for (std::size_t i = 0; i < n_; ++i)
      if (now_.held[i]) take(n_ + shown_ + i, nullptr, limits_.row(i));
  }
  /// Slopes of what a pack's lanes answer. The lane that nothing moves is overwritten by the next pack.
  void keep(std::size_t pack, const P8& lanes, const P8& per_move, std::size_t row) {
    const P8 slopes = (lanes - P8(lanes[kBase])) * per_move;
    slopes.store(slopes_.data() + row * moves_ + pack * kBase);
  }
  /// A row of these by states and by directions.
  void take(std::size_t row, P8* by_state, P8* by_direction) {
    const double* slopes = slopes_.data() + row * moves_;
    auto* directions = reinterpret_cast<double*>(by_direction);
    if (by_state) std::memcpy(by_state, slopes, n_ * sizeof(double));
    slopes += n_;
    for (const Run& r : runs_) {
      std::memcpy(directions + r.first, slopes, r.length * sizeof(double));
      slopes += r.length;
    }
    for (const Kind kind : {Kind::torque, Kind::field}) {
      if (!(kind == Kind::torque ? has_torque_ : has_field_)) continue;
      const double slope = *slopes++;
      for (std::size_t d = 0; d < active_; ++d)
        if (directions_[d].kind == kind) directions[d] = slope * heights_[d];
    }
  }

  /// Over an interval of h [s]: (I - h A/2 - h A0/6 + h^2 A^2/6) S = S0 + h A0 S0/3 + h (B0 + B)/2 - h^2 A
  /// B/6, which is the formula with the derivatives of A and B between the two nodes as their differences.
  void step(double h) {
    const std::size_t wide = packs(), square = (n_ + kLanes - 1) / kLanes;
    const Linear& end = meets_a_limit() ? before_ : now_;
    for (std::size_t i = 0; i < n_; ++i) {
      left_.clear(i);
      left_.at(i, i) = 1.0;
      add(left_.row(i), -h / 2, end.A.row(i), square);
      add(left_.row(i), -h / 6, before_.A.row(i), square);
      for (std::size_t j = 0; j < n_; ++j) {
        factors_[j] = h * h / 6 * end.A.at(i, j);
        more_factors_[j] = h / 3 * before_.A.at(i, j);
      }
      in_chunks(square, [&]<std::size_t count>(std::size_t first) {
        P8 sum[count];
        std::copy_n(left_.row(i) + first, count, sum);
        add_rows<count>(sum, factors_.data(), end.A, 0, n_, first);
        std::copy_n(sum, count, left_.row(i) + first);
      });
      for (double& factor : factors_) factor = -factor;
      in_chunks(wide, [&]<std::size_t count>(std::size_t first) {
        P8 sum[count];
        const P8 half(h / 2);
        for (std::size_t p = 0; p < count; ++p)
          sum[p] = S_.row(i)[first + p] + half * (before_.B.row(i)[first + p] + end.B.row(i)[first + p]);
        add_rows<count>(sum, factors_.data(), end.B, 0, n_, first);
        add_rows<count>(sum, more_factors_.data(), S_, 0, n_, first);
        std::copy_n(sum, count, right_.row(i) + first);
      });
    }
    factorise(square);
    solve(wide);
    std::swap(S_, right_);
  }
  /// Calls act<packs>(first) for runs of packs so short that their sums stay in registers.
  template <class Act>
  static void in_chunks(std::size_t packs, Act act) {
    std::size_t first = 0;
    for (; first + 4 <= packs; first += 4) act.template operator()<4>(first);
    if (packs - first == 3) act.template operator()<3>(first);
    if (packs - first == 2) act.template operator()<2>(first);
    if (packs - first == 1) act.template operator()<1>(first);
  }
  /// sum += factors * rows from `begin` to `end`, of the packs from `first` on.
  template <std::size_t count>
  static void add_rows(P8* sum, const double* factors, const Rows& rows, std::size_t begin, std::size_t end,
                       std::size_t first) {
    for (std::size_t j = begin; j < end; ++j) {
      if (factors[j] == 0.0) continue;
      const P8 factor(factors[j]);
      const P8* row = rows.row(j) + first;
      for (std::size_t p = 0; p < count; ++p) sum[p] = sum[p] + factor * row[p];
    }
  }
  /// A state that is held at the end alone moved until then.
  [[nodiscard]] bool meets_a_limit() const {
    for (std::size_t i = 0; any_held_ && i < n_; ++i)
      if (now_.held[i] && !before_.held[i]) return true;
    return false;
  }
  /// left <- its triangles, with pivots: right's rows go with them.
  void factorise(std::size_t square) {
    for (std::size_t k = 0; k < n_; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < n_; ++i)
        if (std::abs(left_.at(i, k)) > std::abs(left_.at(pivot, k))) pivot = i;
      if (pivot != k) {
        std::swap_ranges(left_.row(k), left_.row(k) + square, left_.row(pivot));
        std::swap_ranges(right_.row(k), right_.row(k) + packs(), right_.row(pivot));
      }
      const double per = 1 / left_.at(k, k);
      for (std::size_t i = k + 1; i < n_; ++i) {
        const double factor = left_.at(i, k) *= per;
        for (std::size_t j = k + 1; factor != 0.0 && j < n_; ++j) left_.at(i, j) -= factor * left_.at(k, j);
      }
    }
  }
  /// right <- left^-1 right, by its triangles.
  void solve(std::size_t wide) {
    for (std::size_t i = 1; i < n_; ++i) {
      for (std::size_t j = 0; j < i; ++j) factors_[j] = -left_.at(i, j);
      in_chunks(wide, [&]<std::size_t count>(std::size_t first) {
        P8 sum[count];
        std::copy_n(right_.row(i) + first, count, sum);
        add_rows<count>(sum, factors_.data(), right_, 0, i, first);
        std::copy_n(sum, count, right_.row(i) + first);
      });
    }
    for (std::size_t i = n_; i-- > 0;) {
      for (std::size_t j = i + 1; j < n_; ++j) factors_[j] = -left_.at(i, j);
      const P8 per(1 / left_.at(i, i));
      in_chunks(wide, [&]<std::size_t count>(std::size_t first) {
        P8 sum[count];
        std::copy_n(right_.row(i) + first, count, sum);
        add_rows<count>(sum, factors_.data(), right_, i + 1, n_, first);
        for (std::size_t p = 0; p < count; ++p) right_.row(i)[first + p] = sum[p] * per;
      });
    }
  }
  /// To the other side of an instant.
  void cross(std::size_t k) {
    const Trace::Passed& passed = trace_.nodes[k - 1].passed;
    if (passed.guard < 0) return switch_over(k);
    const double *before = trace_.dx.data() + (k - 1) * n_, *after = trace_.dx.data() + k * n_;
    for (std::size_t d = 0; d < m_; ++d) {
      double moved = d < active_ ? guard_.at(1, d) : 0.0;  // the guard, at the instant as it is
      for (std::size_t i = 0; i < n_; ++i) moved += guard_.at(0, i) * S_.at(i, d);
      later_[d] = -moved / passed.rate;
    }
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t d = 0; d < m_; ++d) S_.at(i, d) += later_[d] * (before[i] - after[i]);
  }
  /// To the other side of a switching, which its directions move and turn.
  void switch_over(std::size_t k) {
    const int switching = trace_.nodes[k].switching;
    const double *before = trace_.dx.data() + (k - 1) * n_, *after = trace_.dx.data() + k * n_;
    for (std::size_t d = 0; d < m_; ++d) {
      const Direction& along = directions_[d];
      if (switching < 0 || along.index != switching) continue;
      if (along.kind == Kind::turn && packs_.front().equations.has_rotor()) S_.at(0, d) -= along.scale;
      for (std::size_t i = 0; along.kind == Kind::switching && i < n_; ++i)
        S_.at(i, d) += along.scale * (before[i] - after[i]);
    }
  }
  void record() {
    const std::size_t wide = packs();
    std::vector<P8>& y = row_;
    y.assign((m_ + kLanes - 1) / kLanes, P8(0.0));
    for (std::size_t o = 0; o < shown_; ++o) {
      const auto output = static_cast<std::size_t>(run_.linear_slopes[o]);
      std::copy_n(now_.D.row(o), wide, y.data());
      for (std::size_t i = 0; i < n_; ++i) factors_[i] = now_.C.at(o, i);
      in_chunks(wide, [&]<std::size_t count>(std::size_t first) {
        add_rows<count>(y.data() + first, factors_.data(), S_, 0, n_, first);
      });
      for (std::size_t d = 0; d < m_; ++d)
        answer_.slopes[d].value[output].push_back(d < active_ ? y[d / kLanes][int(d % kLanes)] : 0.0);
    }
  }

  const Drive& run_;
  std::span<const Direction> directions_;
  const Trace& trace_;
  Response& answer_;
  const std::size_t n_, m_;    ///< states, directions
  std::size_t active_ = 0;     ///< directions whose input has begun
  std::vector<double> begin_;  ///< of a direction's input [s]
  std::vector<Run> runs_;      ///< directions that are in the coefficients
  std::size_t seeded_ = 0;     ///< how many
  std::size_t moves_ = 0;      ///< length of a row of `slopes_`
  bool has_torque_ = false, has_field_ = false, any_held_ = false;
  std::vector<Pack> packs_;
  Rows S_, limits_;
  std::size_t shown_;  ///< outputs whose slopes are asked for
  Linear before_, now_;
  Rows left_, right_, guard_;  ///< the last: slopes of the guard that is passed, by states and by directions
  std::vector<double> factors_, more_factors_, later_;
  std::vector<P8> x_, dx_, row_, moved_guards_;
  std::vector<double> sign_, outward_, heights_;
  std::vector<double> slopes_;  ///< of derivatives, outputs, limits, by moves
};

}  // namespace

bool can_be_linear(const Drive& run) {
  return !is_recorded(*run.plant) && !run.given && !run.record->breaker() && !run.record->open_circuit();
}

bool add_linear_slopes(const Drive& run, std::span<const Direction> directions, const Trace& trace,
                       Response& answer) {
  return LinearSlopes(run, directions, trace, answer).run();
}

}  // namespace swingbank::validate::playin
