// blind-second: writes blind cases of the independent simulator (one machine against a Thevenin grid) into
// the folders that `swingbank blind-test --judge --score` reads.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>

#include "research/blind/cases/detail/effects.hpp"
#include "research/blind/cases/detail/world.hpp"
#include "research/blind/cases/plan.hpp"
#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"
#include "tests/blind/second/disturbances.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::research;
using namespace swingbank::validate;
namespace second = blind_second;
namespace fs = std::filesystem;

constexpr double kMva = 200.0;  ///< base of every machine here [MVA]

struct Unstable {};

second::MachineData draw_machine(blind::cases::BlindDraw& d) {
  const auto about = [&](double x) { return x * d.uniform(0.9, 1.1); };
  second::MachineData m{about(6.5),  about(0.06), about(0.9),  about(0.08), about(4.0),
                        0.0,         about(1.8),  about(1.65), about(0.36), about(0.58),
                        about(0.25), about(0.14), 0.0,         0.0,         0.0};
  if (d.coin()) m.D = d.uniform(0.3, 2.0);
  if (d.coin()) m.S10 = d.uniform(0.05, 0.15), m.S12 = m.S10 * d.uniform(3.5, 5.0);
  return m;
}

/// A fault on the line to the grid, at 20 to 90 % of its length.
blind::cases::BlindEvent fault(second::Setup& s, blind::cases::BlindDraw& d) {
  const second::Phasor line(d.uniform(0.01, 0.03), d.uniform(0.15, 0.35));
  const second::Phasor zf(d.uniform(0, 0.02), d.uniform(0.005, 0.15));
  const double along = d.uniform(0.2, 0.9), on = d.uniform(1.5, 2.0), off = on + d.uniform(0.06, 0.14);
  const second::Phasor source = second::source_voltage(s, line), far = (1 - along) * line;
  s.grid = {{0, source, line},
            {on, source * zf / (zf + far), along * line + zf * far / (zf + far)},
            {off, source, line}};
  return {fmt::format("fault at {:.0f} % of the line from {:.5f} to {:.5f} s", 100 * along, on, off),
          {},
          {on, off}};
}
blind::cases::BlindEvent frequency_dip(second::Setup& s, blind::cases::BlindDraw& d) {
  const second::Phasor line(d.uniform(0.01, 0.03), d.uniform(0.15, 0.35));
  s.grid = {{0, second::source_voltage(s, line), line}};
  s.dip = {d.uniform(1.5, 2.0), -d.uniform(0.003, 0.008), d.uniform(1.5, 3.0)};
  return {fmt::format("frequency falls by {:.4f} pu from {:.5f} s", -s.dip.depth, s.dip.start), {}, {}};
}

/// Adds the hidden effect of this kind to the setup. `size`: 0 to 1, relative to the kind's usual maximum.
void hide(const std::string& kind, double size, second::Setup& s, blind::cases::BlindDraw& d) {
  if (kind == "SEXS") {
    s.exciter = second::Sexs{.ratio = 0.1, .TB = 10, .K = 200 * size, .TE = 0.05, .low = -4, .high = 5.5};
  } else if (kind == "TGOV1") {
    s.governor =
        second::Tgov1{.R = 0.04 / size, .T1 = 0.5, .high = 1.2, .low = 0, .T2 = 2.1, .T3 = 7, .Dt = 0};
  } else if (kind == "saturation") {
    s.machine.S10 = 0.2 * size, s.machine.S12 = 0.8 * size;
  } else if (kind == "IEEEST") {
    s.stabiliser = second::Ieeest{.KS = 20 * size};
  } else if (kind == "STEPUP") {
    s.transformer = {0.0, 0.2 * size};
  } else if (kind == "CTERROR") {
    s.ct_error = std::polar(1.0, 0.1 * size);
  } else if (kind == "sawtooth") {
    s.unlisted = second::sawtooth(0.1 * size, d.uniform(0.2, 0.8), d.uniform(2.0, 4.0), 20.0);
  } else if (kind == "fieldloss") {
    s.unlisted = second::field_loss(0.4 * size, d.uniform(3.0, 8.0));
  } else if (kind == "limitcycle") {
    s.unlisted = second::limit_cycle(size, d.uniform(0.3, 0.8), 1.0);
  } else if (kind == "stickslip") {
    s.unlisted = second::stick_slip(0.05 * size, 0.001);
  } else if (kind == "randomwalk") {
    s.unlisted = second::random_walk(0.03 * size, 0.4, 2.3, 20.0, static_cast<unsigned>(d.bits()));
  }
}
const std::vector<std::string> kKinds = {"SEXS",       "TGOV1",     "saturation", "IEEEST",
                                         "STEPUP",     "CTERROR",   "sawtooth",   "fieldloss",
                                         "limitcycle", "stickslip", "randomwalk"};

record::Record record_of(const second::Output& out) {
  for (std::size_t k = 0; k < out.t.size(); ++k)
    if (!(std::abs(out.w[k]) < 0.02) || !std::isfinite(out.P[k])) throw Unstable{};
  record::Record r;
  r.base.mva = blind::cases::kRecordMva;
  r.t = out.t, r.V = out.V, r.theta = out.theta, r.P = out.P, r.Q = out.Q, r.speed = out.w, r.Ifd = out.Ifd;
  for (auto* channel : {&r.P, &r.Q})
    for (double& value : *channel) value *= kMva / blind::cases::kRecordMva;
  return r;
}

sim::plant::Block block(const std::string& name, const std::map<std::string, double>& values) {
  sim::plant::Block b{sim::library::compiled().find(name), {}};
  b.p = b.effect->default_parameters();
  for (const auto& [key, value] : values)
    b.p.at(static_cast<std::size_t>(b.effect->parameter_index(key))) = value;
  return b;
}
/// The submitted plant model, with the right parameters.
sim::plant::Plant known_plant(const second::Setup& s) {
  const auto& m = s.machine;
  sim::plant::Plant p;
  p.mva = kMva;
  p.name = "second";
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
  if (s.exciter)
    p.controls.push_back(block("SEXS", {{"TAoverTB", s.exciter->ratio},
                                        {"TB", s.exciter->TB},
                                        {"K", s.exciter->K},
                                        {"TE", s.exciter->TE},
                                        {"EMIN", s.exciter->low},
                                        {"EMAX", s.exciter->high}}));
  return p;
}

blind::cases::BlindCase make(const blind::cases::BlindConfig& config, const blind::cases::BlindSpec& spec,
                             blind::cases::BlindDraw& d) {
  blind::cases::BlindCase made;
  made.spec = spec;
  made.maker = "second";
  made.grid_name = "thevenin";
  made.plant_name = "second";
  made.conventions = sim::Conventions::psse();
  made.noise = config.noise[d.below(config.noise.size())];
  made.voltage_noise = made.noise * config.voltage_noise;
  made.channels = d.coin(config.channels_share);
  const std::string kind = spec.hidden.empty() ? "" : spec.hidden.front()->name;
  second::Setup plain;
  plain.machine = draw_machine(d);
  plain.P = d.uniform(0.5, 0.85), plain.Q = d.uniform(-0.1, 0.3), plain.V = d.uniform(0.98, 1.05);
  if (kind == "saturation") plain.machine.S10 = plain.machine.S12 = 0;
  if (kind == "IEEEST" || (kind != "SEXS" && d.coin()))
    plain.exciter =
        second::Sexs{.ratio = 0.1, .TB = 10, .K = d.uniform(80, 150), .TE = 0.05, .low = -4, .high = 5.5};
  blind::cases::BlindTruth truth;
  truth.scale = d.log_uniform(0.02, 1.0);
  second::Setup with = plain;
  hide(kind, truth.scale, with, d);
  std::vector<record::Record> without;
  for (int k = 0; k < config.faults + config.frequency_events; ++k) {
    second::Setup a = plain, b = with;
    a.dip = {};
    made.events.push_back(k < config.faults ? fault(a, d) : frequency_dip(a, d));
    b.grid = a.grid, b.dip = a.dip;
    without.push_back(record_of(second::simulate(a, config.seconds, config.rate)));
    made.records.push_back(record_of(second::simulate(b, config.seconds, config.rate)));
  }
  made.model = made.truth = known_plant(plain);
  if (!kind.empty()) {
    const blind::cases::BlindSize size({made.model, made.conventions}, made.events, without,
                                       made.noise * kMva / without.front().base.mva, made.voltage_noise);
    truth.kind = spec.hidden.front();
    truth.left = size.left(made.records);
    truth.visible = size.visible(made.records);
    made.hidden.push_back(truth);
  }
  if (!blind::cases::mislead(made.model.machine, config.wrong, d)) throw Unstable{};
  for (record::Record& record : made.records)
    blind::cases::add_noise(record, {made.noise, kMva, made.voltage_noise, config.speed_noise}, made.channels,
                            d);
  return made;
}

blind::cases::BlindCase make_stable(const blind::cases::BlindConfig& config,
                                    const blind::cases::BlindSpec& spec) {
  for (std::uint64_t attempt = 0; attempt < 60; ++attempt) {
    blind::cases::BlindDraw draw(spec.seed, spec.index, 0x5ec0 + attempt);
    try {
      blind::cases::BlindCase made = make(config, spec, draw);
      made.attempts = static_cast<int>(attempt) + 1;
      return made;
    } catch (const Unstable&) {  // drawn again
    }
  }
  throw InputError({"no stable case in 60 attempts", fmt::format("case {}", spec.index), "a speed left 2 %",
                    "choose another seed"});
}

int run(const std::string& file, const std::string& out, int count, std::uint64_t seed) {
  blind::cases::BlindConfig config = blind::cases::load_blind_config(file);
  std::erase_if(config.kinds, [](const blind::cases::BlindKind& k) {
    return std::ranges::find(kKinds, k.name) == kKinds.end();
  });
  const blind::cases::BlindPlan plan =
      blind::cases::plan_blind(config, {"listed", "odd", "none"}, count, seed, 0);
  blind::cases::settle_plan(plan, config, out);
  for (std::size_t k = 0; k < plan.cases.size(); ++k) {
    const std::string name = blind::cases::case_name(k);
    const fs::path folder = fs::path(out) / "cases" / name;
    if (fs::exists(folder)) continue;
    blind::cases::write_blind_case(make_stable(config, plan.cases[k]), config, name, folder,
                                   fs::path(out) / "truth" / (name + ".json"));
    fmt::print("{} of {}\n", k + 1, plan.cases.size());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"blind cases of the independent simulator of machine, controls and disturbances",
               "blind-second"};
  std::string config, out;
  int count = 0;
  std::uint64_t seed = 1;
  app.add_option("--config", config, "configs/blind/cases.toml")->required();
  app.add_option("--out", out, "folder of the run")->required();
  app.add_option("--make", count, "number of cases: a third listed, a third odd, a third with nothing hidden")
      ->required();
  app.add_option("--seed", seed, "seed of the run")->capture_default_str();
  try {
    app.parse(argc, argv);
    return run(config, out, count, seed);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
