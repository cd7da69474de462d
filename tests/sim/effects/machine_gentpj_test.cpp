// GENTPJ: hand-calculated steady states, current against a bisection, equality with GENROU for the same
// machine, response of a plant in both integrators.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "sim/batch/batch.hpp"
#include "sim/core/effect.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

using Changes = std::vector<std::pair<const char*, double>>;

struct TypeJMachine {
  TypeJMachine(const char* name, const Changes& changes, Complex v, Complex i,
               Conventions conventions = Conventions::psse())
      : effect(*library::compiled().find(name)) {
    p = effect.default_parameters();
    for (const auto& [parameter, value] : changes) at(parameter) = value;
    c.resize(static_cast<std::size_t>(effect.coefficients));
    x.resize(effect.states.size());
    m.resize(static_cast<std::size_t>(effect.scratch));
    s.Vr = v.real();
    s.Vi = v.imag();
    s.Ir = i.real();
    s.Ii = i.imag();
    ops().machine.source_impedance(p.data(), r, xs);
    ops().prepare(p.data(), conventions, c.data());
    refused = ops().machine.steady(p.data(), c.data(), s, x.data());
  }
  double& at(const char* parameter) { return p[static_cast<std::size_t>(effect.parameter_index(parameter))]; }
  [[nodiscard]] const Ops<double>& ops() const { return effect.get<double>(); }
  /// Derivatives and current at terminal voltage v, Efd and Tm as they are.
  std::vector<double> derivatives(Complex v) {
    std::vector<double> dx(x.size());
    double er, ei;
    ops().machine.emf(c.data(), x.data(), m.data(), er, ei);
    s.Vr = v.real();
    s.Vi = v.imag();
    if (ops().machine.current) {
      ops().machine.current(c.data(), x.data(), m.data(), s);
    } else {
      const Complex i = (Complex(er, ei) - v) / Complex(r, xs);
      s.Ir = i.real();
      s.Ii = i.imag();
    }
    ops().machine.electrical(c.data(), x.data(), m.data(), s);
    ops().machine.derivative(c.data(), x.data(), m.data(), s, dx.data());
    return dx;
  }
  const Effect& effect;
  std::vector<double> p, c, x, m;
  Signals<double> s;
  double r = 0, xs = 0;
  std::string refused;
};

double quadratic(double s10, double s12, double u) {  // sqrt(u Se) is a straight line above A
  const double root = std::sqrt(s10) + (std::sqrt(1.2 * s12) - std::sqrt(s10)) * (u - 1.0) / 0.2;
  return root > 0 ? root * root / u : 0.0;
}

/// At no load psi'' = E'q = V = 1 and the field needs 1 + S1.0. Over-excited by the current -jI at V = 1 all
/// flux lies in the d axis: the air-gap flux is 1 + Xl I, so u = 1 + (Xl + Kis) I, and the field needs
/// (1 + Se) times the flux behind the saturated reactances: (1 + Se)(1 + Xl I) + (Xd - Xl) I.
TEST(MachineGentpj, FieldByHand) {
  EXPECT_NEAR(TypeJMachine("GENTPJ", {}, 1.0, 0.0).s.Efd, 1.1, 1e-14);  // tolerances: rounding
  TypeJMachine over("GENTPJ", {{"Kis", 0.1}}, 1.0, {0.0, -0.8});        // 1 + (0.15 + 0.1) 0.8 = 1.2
  EXPECT_NEAR(over.s.Efd, 1.4 * (1.0 + 0.15 * 0.8) + (1.8 - 0.15) * 0.8, 1e-14);
  EXPECT_NEAR(over.x[0], 0.0, 1e-14);
  TypeJMachine flux_alone("GENTPJ", {{"Kis", 0.0}}, 1.0, {0.0, -0.8});
  EXPECT_NEAR(flux_alone.s.Efd, (1.0 + quadratic(0.1, 0.4, 1.12)) * 1.12 + 1.65 * 0.8, 1e-14);
}

/// The q axis lies along V + (Ra + jXqs) I with Xqs = Xl + (Xq - Xl)/(1 + Se Xq/Xd).
TEST(MachineGentpj, AngleFollowsTheSaturatedQuadratureReactance) {
  TypeJMachine m("GENTPJ", {{"Kis", 0.08}, {"Ra", 0.01}}, 1.0, 0.9);
  const double u = std::hypot(1.0 + 0.01 * 0.9, 0.15 * 0.9) + 0.08 * 0.9, Se = quadratic(0.1, 0.4, u);
  const double xqs = 0.15 + (1.7 - 0.15) / (1.0 + Se * 1.7 / 1.8);
  EXPECT_NEAR(m.x[0], std::atan2(xqs * 0.9, 1.0 + 0.01 * 0.9), 1e-14);
  EXPECT_NEAR(m.s.Tm, 0.9 + 0.01 * 0.9 * 0.9, 1e-14);  // losses of the stator
}

/// Without saturation and with Xl = X'' in GENROU's rotor circuits, both have the same equations.
TEST(MachineGentpj, EqualsGenrouWithSubtransientLeakage_WithoutSaturation) {
  for (const auto& conventions : {Conventions::psse(), Conventions::andes(), Conventions{}}) {
    const Complex v = std::polar(1.02, 0.1), i(0.8, -0.3), dip = std::polar(0.6, 0.2);
    const Changes common = {{"S10", 0.0}, {"S12", 0.0},  {"Xdpp", 0.25},
                            {"Xqp", 0.5}, {"Ra", 0.005}, {"D", 1.0}};
    Changes mine = common, theirs = common;
    mine.insert(mine.end(), {{"Xqpp", 0.25}, {"Kis", 0.2}});
    theirs.emplace_back("Xl", 0.25);
    TypeJMachine a("GENTPJ", mine, v, i, conventions), b("GENROU", theirs, v, i, conventions);
    for (const char* name : {"Tdop", "Tdopp", "Tqop", "Tqopp", "H", "Xd", "Xq", "Xdp"})
      ASSERT_EQ(a.at(name), b.at(name)) << name;
    ASSERT_EQ(a.x.size(), b.x.size());
    for (std::size_t k = 0; k < a.x.size(); ++k) EXPECT_NEAR(a.x[k], b.x[k], 1e-14) << k;
    EXPECT_NEAR(a.s.Efd, b.s.Efd, 1e-13);
    a.x[1] = b.x[1] = 0.01;
    a.x[2] = b.x[2] += 0.1;
    a.x[4] = b.x[4] -= 0.1;
    const auto da = a.derivatives(dip), db = b.derivatives(dip);
    for (std::size_t k = 0; k < da.size(); ++k)  // rounding of about 1 over T'' = 0.04 s
      EXPECT_NEAR(da[k], db[k], 1e-11) << k;
    EXPECT_NEAR(a.s.Ir, b.s.Ir, 1e-12);
    EXPECT_NEAR(a.s.Ifd, b.s.Ifd, 1e-12);
  }
}

/// Bisection for Se: the flux of the resulting current must give the same Se.
TEST(MachineGentpj, CurrentIsConsistentWithItsSaturation) {
  for (const double kis : {0.0, 0.05, 0.15})
    for (const double depth : {1.0, 0.8, 0.3, 0.0})
      for (const double s12 : {0.2, 0.4, 1.2}) {
        TypeJMachine m("GENTPJ", {{"Kis", kis}, {"S12", s12}, {"Ra", 0.003}}, std::polar(1.05, 0.2),
                       {0.9, -0.4});
        const Complex v = std::polar(depth * 1.05, 0.15), turn(std::sin(m.x[0]), std::cos(m.x[0]));
        const Complex dq = v * turn;  // d + jq of the frame that the machine uses
        const auto dq_current = [&](double se) {
          const double xd = 0.15 + 0.1 / (1 + se), xq = 0.15 + 0.12 / (1 + se * 1.7 / 1.8);
          const double a = -m.x[5] - dq.real(), b = m.x[4] - dq.imag(), det = 0.003 * 0.003 + xd * xq;
          return Complex(0.003 * a + xq * b, 0.003 * b - xd * a) / det;
        };
        const auto excess = [&](double se) {
          const Complex i = dq_current(se);
          const double fd = dq.real() + 0.003 * i.real() - 0.15 * i.imag(),
                       fq = dq.imag() + 0.003 * i.imag() + 0.15 * i.real();
          return se - quadratic(0.1, s12, std::hypot(fd, fq) + kis * std::abs(i));
        };
        double low = 0.0, high = 50.0;
        for (int halving = 0; halving < 60; ++halving)
          (excess((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
        m.derivatives(v);
        const Complex expected = dq_current(low) * std::conj(turn);
        EXPECT_NEAR(m.s.Ir, expected.real(), 1e-10) << kis << " " << depth << " " << s12;
        EXPECT_NEAR(m.s.Ii, expected.imag(), 1e-10) << kis << " " << depth << " " << s12;
      }
}

/// SIMD batch against the reference: bolted faults at plant 3 and elsewhere, loss of plant 3.
void expect_batch_equals_reference(const grid::Grid& grid) {
  const plant::Plant& mine = grid.plants[3];
  std::vector<network::Event> events(3);
  events[0].faults = {{mine.bus, 1.0, 1.06, {}}};
  events[1].faults = {{grid.network.bus_index(16), 1.0, 1.08, {}}};
  events[2].generator_trips = {{mine.generator, 1.0}};
  reference::ReferenceOptions exact;
  exact.t_end = 5.0;
  batch::BatchOptions options;
  options.t_end = exact.t_end;
  options.rate = exact.rate;
  std::size_t next = 0, done = 0;
  batch::Batch batch(grid, options);
  batch.run(
      [&](batch::Job& job) {
        if (next == events.size()) return false;
        job.id = next;
        job.event = events[next++];
        return true;
      },
      [&](const batch::Job& job, const Trajectory& run) {
        ++done;
        EXPECT_EQ(run.outcome, Outcome::stable) << job.id;
        // required bound
        EXPECT_LE(test::largest_difference(run, reference::run_reference(grid, job.event, exact)), 1e-4)
            << job.id;
      });
  EXPECT_EQ(done, events.size());
}

/// IEEE 39 with GENTPJ as every second machine.
grid::Grid every_second() {
  grid::Grid grid = test::configured_grid("ieee39_dataset_genrou", Conventions::psse());
  const Effect& gentpj = *library::compiled().find("GENTPJ");
  for (std::size_t i = 1; i < grid.plants.size(); i += 2)
    grid.plants[i].machine = {&gentpj, gentpj.default_parameters()};
  return grid;
}
TEST(MachineGentpj, LanesEqualTheReference) { expect_batch_equals_reference(every_second()); }
TEST(MachineGentpj, LanesEqualTheReferenceBehindTransformers) {
  grid::Grid grid = every_second();
  for (const std::size_t i : {3, 4, 7})
    grid.plants[i].transformer = {library::compiled().find("STEPUP"), {0.004, 0.12, 1.04}};
  expect_batch_equals_reference(grid);
}
/// Without saturation it equals the GENROU of the test above, also behind a transformer.
TEST(MachineGentpj, EqualsGenrouBehindATransformer_WithoutSaturation) {
  grid::Grid linear = test::two_machine_grid(Conventions::psse());
  plant::Plant& plant = linear.plants[1];
  plant.transformer = {library::compiled().find("STEPUP"), {0.004, 0.12, 1.04}};
  grid::Grid mine = linear;
  const auto set = [](plant::Plant& p, const char* effect, const Changes& changes) {
    p.machine = {library::compiled().find(effect), library::compiled().find(effect)->default_parameters()};
    for (const auto& [name, value] : changes)
      p.machine.p[static_cast<std::size_t>(p.machine.effect->parameter_index(name))] = value;
  };
  set(plant, "GENROU", {{"S10", 0.0}, {"S12", 0.0}, {"Xdpp", 0.25}, {"Xl", 0.25}, {"Xqp", 0.5}});
  set(mine.plants[1], "GENTPJ",
      {{"S10", 0.0}, {"S12", 0.0}, {"Xdpp", 0.25}, {"Xqpp", 0.25}, {"Kis", 0.2}, {"Xqp", 0.5}});
  network::Event event;
  event.faults = {{linear.network.bus_index(2), 1.0, 1.1, {0.0, 0.05}}};
  reference::ReferenceOptions options;
  options.t_end = 4.0;
  // two runs of IDA at rtol 1e-8 with other rounding
  EXPECT_LE(test::largest_difference(reference::run_reference(linear, event, options),
                                     reference::run_reference(mine, event, options)),
            1e-6);
}

TEST(MachineGentpj, SingularValuesAreRefused) {
  const Effect& effect = *library::compiled().find("GENTPJ");
  for (const auto& [name, value] : {std::pair{"Tdopp", 0.0},
                                    {"Xdp", 0.25},
                                    {"Xqp", 0.2},
                                    {"H", 0.0},
                                    {"S12", 0.05},
                                    {"Tqop", 0.0},
                                    {"Xl", 0.26},
                                    {"Kis", -0.1}}) {
    auto p = effect.default_parameters();
    p[static_cast<std::size_t>(effect.parameter_index(name))] = value;
    Problems problems;
    effect.check(nullptr, p.data(), "test", problems);
    EXPECT_FALSE(problems.empty()) << name;
  }
}

TEST(MachineGentpj, AcceptsAMissingQAxisTransientCircuit) {
  TypeJMachine m("GENTPJ", {{"Tqop", 0.0}, {"Xq", 1.1}, {"Xqp", 1.1}}, 1.0, {0.8, -0.2});
  Problems problems;
  m.effect.check(nullptr, m.p.data(), "test", problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_NEAR(m.x[3], 0.0, 1e-15);
  for (const double d : m.derivatives(1.0)) EXPECT_NEAR(d, 0.0, 1e-12);
}

}  // namespace
}  // namespace swingbank::sim::effects
