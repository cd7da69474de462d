// The product's effects against the independent second simulator: its records, played into the product's
// plant, must give the same P and Q.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"
#include "tests/blind/second/disturbances.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank {
namespace {

namespace second = blind_second;
using validate::record::Record;

constexpr double kOn = 1.5137, kOff = 1.6219;  ///< start and end of the fault, between samples [s]
/// Interpolating V between samples at 240/s causes an error up to 2e-5 pu (validate/playin/README.md: 1.2e-6
/// at 120/s without controller gain, 2.6e-5 at 60/s). A wrong coefficient causes an error a thousand times as
/// large.
constexpr double kTolerance = 2e-4;

second::Setup base() {
  second::Setup s;
  s.machine = {6.5, 0.06, 0.9, 0.08, 4.2, 1.0, 1.8, 1.7, 0.38, 0.58, 0.28, 0.16, 0.0, 0.0, 0.002};
  const second::Phasor line(0.02, 0.3), fault(0.0, 0.08);
  const second::Phasor far = 0.5 * line, behind = fault * far / (fault + far);
  const second::Phasor source = second::source_voltage(s, line);
  s.grid = {{0.0, source, line}, {kOn, source * fault / (fault + far), far + behind}, {kOff, source, line}};
  s.dip = {3.0, -0.004, 2.0};
  return s;
}

sim::plant::Block block(const std::string& name, const std::map<std::string, double>& values) {
  sim::plant::Block b{sim::library::compiled().find(name), {}};
  b.p = b.effect->default_parameters();
  for (const auto& [parameter, value] : values)
    b.p.at(static_cast<std::size_t>(b.effect->parameter_index(parameter))) = value;
  return b;
}

sim::plant::Plant plant(const second::Setup& s) {
  sim::plant::Plant p;
  p.mva = 100.0;
  const auto& m = s.machine;
  p.machine = block("GENROU", {{"Tdop", m.Tdo1},
                               {"Tdopp", m.Tdo2},
                               {"Tqop", m.Tqo1},
                               {"Tqopp", m.Tqo2},
                               {"H", m.H},
                               {"D", m.D},
                               {"Xd", m.Xd},
                               {"Xq", m.Xq},
                               {"Xdp", m.Xd1},
                               {"Xqp", m.Xq1},
                               {"Xdpp", m.X2},
                               {"Xl", m.Xl},
                               {"S10", m.S10},
                               {"S12", m.S12},
                               {"Ra", m.Ra}});
  return p;
}

Record record_of(const second::Output& out) {
  Record r;
  r.t = out.t;
  r.V = out.V;
  r.theta = out.theta;
  r.P = out.P;
  r.Q = out.Q;
  return r;
}

/// Largest difference of P and Q between the record and the played-in plant [pu].
double largest_difference(const second::Setup& s, const sim::plant::Plant& p) {
  const Record r = record_of(second::simulate(s, 8.0, 240.0));
  const validate::playin::VoltageCurve curve(r, {{.time = kOn}, {.time = kOff}});
  const auto model = validate::playin::play_in({p, sim::Conventions::psse()}, r, curve);
  double largest = 0;
  for (std::size_t k = 0; k < r.t.size(); ++k)
    largest = std::max({largest, std::abs(r.P[k] - model.P[k]), std::abs(r.Q[k] - model.Q[k])});
  return largest;
}

void put(sim::plant::Plant& p, sim::plant::Block b) {
  ASSERT_FALSE(sim::plant::place(p, std::move(b), "test").has_value());
}

TEST(IndependentSimulator, MachineAgrees) {
  EXPECT_LT(largest_difference(base(), plant(base())), kTolerance);
}

TEST(IndependentSimulator, StaysAtRest_WithoutAnEvent) {
  second::Setup s = base();
  s.machine.S10 = 0.1, s.machine.S12 = 0.5;
  s.exciter = second::Sexs{};
  s.governor = second::Tgov1{};
  s.stabiliser = second::Ieeest{};
  s.grid.resize(1);
  s.dip = {};
  const second::Output out = second::simulate(s, 5.0);
  // No mode amplifies the rounding of the initial values (1e-16) noticeably within five seconds.
  for (std::size_t k = 0; k < out.t.size(); ++k) ASSERT_NEAR(out.P[k], s.P, 1e-9) << out.t[k];
}

TEST(IndependentSimulator, StepSizeDoesNotMatter) {
  const auto coarse = second::simulate(base(), 4.0), fine = second::simulate(base(), 4.0, 60, 1.0 / 9600);
  // Fourth order: with a quarter of the step, 1/256 of the error remains. The difference is therefore the
  // error of the coarse run.
  for (std::size_t k = 0; k < fine.t.size(); ++k) ASSERT_NEAR(coarse.P[k], fine.P[k], 1e-7) << fine.t[k];
}

TEST(IndependentSimulator, SaturationAgrees) {
  second::Setup s = base();
  s.machine.S10 = 0.12, s.machine.S12 = 0.55;
  EXPECT_LT(largest_difference(s, plant(s)), kTolerance);
  EXPECT_GT(largest_difference(s, plant(base())), 10 * kTolerance);
}

TEST(IndependentSimulator, SexsAgrees) {
  second::Setup s = base();
  s.exciter = second::Sexs{.ratio = 0.1, .TB = 10, .K = 120, .TE = 0.05, .low = -4, .high = 4};
  sim::plant::Plant p = plant(s);
  EXPECT_GT(largest_difference(s, p), 10 * kTolerance);
  put(p, block("SEXS", {{"TAoverTB", 0.1}, {"TB", 10}, {"K", 120}, {"TE", 0.05}, {"EMIN", -4}, {"EMAX", 4}}));
  EXPECT_LT(largest_difference(s, p), kTolerance);
}

TEST(IndependentSimulator, Tgov1Agrees) {
  second::Setup s = base();
  s.governor = second::Tgov1{.R = 0.04, .T1 = 0.4, .high = 0.75, .low = 0, .T2 = 2, .T3 = 7, .Dt = 0.2};
  sim::plant::Plant p = plant(s);
  EXPECT_GT(largest_difference(s, p), 10 * kTolerance);
  put(p, block("TGOV1",
               {{"R", 0.04}, {"T1", 0.4}, {"VMAX", 0.75}, {"VMIN", 0}, {"T2", 2}, {"T3", 7}, {"Dt", 0.2}}));
  EXPECT_LT(largest_difference(s, p), kTolerance);
}

TEST(IndependentSimulator, IeeestAgrees) {
  second::Setup s = base();
  s.exciter = second::Sexs{.ratio = 0.1, .TB = 10, .K = 100, .TE = 0.05, .low = -4, .high = 5};
  s.stabiliser = second::Ieeest{.KS = 12, .high = 0.05, .low = -0.05};
  sim::plant::Plant p = plant(s);
  put(p, block("SEXS", {{"TAoverTB", 0.1}, {"TB", 10}, {"K", 100}, {"TE", 0.05}, {"EMIN", -4}, {"EMAX", 5}}));
  EXPECT_GT(largest_difference(s, p), 10 * kTolerance);
  put(p, block("IEEEST", {{"ICS", 1},
                          {"A1", 0.06},
                          {"A2", 0.0016},
                          {"A3", 0.03},
                          {"A4", 0.0004},
                          {"T1", 0.1},
                          {"T2", 0.02},
                          {"T3", 0.1},
                          {"T4", 0.02},
                          {"T5", 5},
                          {"T6", 5},
                          {"KS", 12},
                          {"LSMAX", 0.05},
                          {"LSMIN", -0.05},
                          {"VCU", 0},
                          {"VCL", 0}}));
  EXPECT_LT(largest_difference(s, p), kTolerance);
}

TEST(IndependentSimulator, StepUpAgrees) {
  second::Setup s = base();
  s.transformer = {0.003, 0.12};
  sim::plant::Plant p = plant(s);
  EXPECT_GT(largest_difference(s, p), 10 * kTolerance);
  p.transformer = block("STEPUP", {{"R", 0.003}, {"X", 0.12}, {"ratio", 1.0}});
  EXPECT_LT(largest_difference(s, p), kTolerance);
}

TEST(IndependentSimulator, CurrentTransformerErrorAgrees) {
  second::Setup right = base(), wrong = base();
  wrong.ct_error = std::polar(1.01, 0.02);
  const auto a = second::simulate(right, 3.0), b = second::simulate(wrong, 3.0);
  sim::Phasors p;
  for (std::size_t k = 0; k < a.t.size(); ++k) {
    p.V.push_back(std::polar(a.V[k], a.theta[k]));
    p.I.push_back(std::conj(std::complex<double>(a.P[k], a.Q[k]) / p.V.back()));
    p.df.push_back(0.0);
  }
  const sim::plant::Block ct = block("CTERROR", {{"gain", 0.01}, {"phase", 0.02}});
  ct.effect->measure(ct.p.data(), 0, p);
  for (std::size_t k = 0; k < a.t.size(); ++k) {
    const auto power = p.V[k] * std::conj(p.I[k]);
    ASSERT_NEAR(power.real(), b.P[k], 1e-12);  // equal but for rounding
    ASSERT_NEAR(power.imag(), b.Q[k], 1e-12);
  }
}

TEST(IndependentSimulator, Sawtooth_HasTheStatedValues) {
  second::Setup s = base();
  s.unlisted = second::sawtooth(0.05, 0.5, 1.9, 8.0);
  const auto out = second::simulate(s, 8.0, 240.0);
  // At 2.4 s, a quarter of the period of 2 s has passed since 1.9 s: -A + 2 A / 4. At 4.2 s, 0.15 of the
  // second period has passed: -A + 0.3 A.
  EXPECT_NEAR(out.Pm[576] - out.Pm[0], -0.025, 1e-9);
  EXPECT_NEAR(out.Pm[1008] - out.Pm[0], -0.035, 1e-9);
  EXPECT_DOUBLE_EQ(out.Pm[240], out.Pm[0]);
}

}  // namespace
}  // namespace swingbank
