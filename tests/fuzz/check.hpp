#pragma once
// Required properties after an input was read without error: all computed values are finite, or an error
// message refuses them.
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/problem.hpp"
#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"
#include "sim/network/powerflow.hpp"
#include "tests/sim/formats/write_raw.hpp"

namespace swingbank::fuzz {

/// Stops the fuzzer with a stack trace.
[[noreturn]] inline void fail(const char* what) {
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}
inline void require(bool condition, const char* what) {
  if (!condition) fail(what);
}

/// Runs `action`. An InputError must contain at least one sentence with all parts filled.
template <class Action>
bool accepted(const Action& action) {
  try {
    action();
    return true;
  } catch (const InputError& error) {
    require(!error.problems().empty(), "an error has a sentence");
    for (const Problem& p : error.problems())
      require(!p.what.empty() && !p.where.empty() && !p.why.empty() && !p.remedy.empty(),
              "a sentence says what, where, why and what to do");
    return false;
  }
}

inline bool finite(Complex z) { return std::isfinite(z.real()) && std::isfinite(z.imag()); }

/// Checks that the power flow of a network is finite or refused. Skips larger networks, which take too long.
inline void check_power_flow(const sim::network::Network& network) {
  if (network.buses.size() > 60) return;
  sim::network::PowerFlow flow;
  if (!accepted([&] { flow = sim::network::solve_power_flow(network); })) return;
  for (const Complex& v : flow.voltage) require(finite(v), "voltages are finite");
  for (const Complex& s : flow.generation) require(finite(s), "generation is finite");
}

/// Checks that a written network is read back unchanged, unless a .raw has no field for one of its values.
inline void check_round_trip(const sim::network::Network& network) {
  for (const sim::network::Branch& b : network.branches)
    if (b.transformer ? b.b != 0.0 || b.shunt_to != Complex{} : b.tap != 1.0 || b.shift != 0.0) return;
  for (const int version : {33, 35}) {
    const std::string once = sim::formats::raw_text(network, version);
    sim::network::Network again;
    require(accepted([&] { again = sim::formats::parse_raw(once, "written"); }),
            "what was written can be read");
    require(sim::formats::raw_text(again, version) == once, "a second round trip changes nothing");
  }
}

/// Reads a network twice by `read`: the first reading refuses repeated equipment, the second omits it.
/// Returns whether the second reading succeeds, and then fills `lenient`. If the first reading succeeds,
/// `whole` is true and `strict` is filled.
template <class Read>
bool read_both_ways(const Read& read, sim::formats::RawOptions options, sim::network::Network& strict,
                    sim::network::Network& lenient, bool& whole) {
  options.drop_refused = false;
  whole = accepted([&] { strict = read(options); });
  options.drop_refused = true;
  if (accepted([&] { lenient = read(options); })) return true;
  require(!whole, "a network without repeated equipment is read with either option");
  return false;
}

inline void quiet() { spdlog::set_level(spdlog::level::off); }

}  // namespace swingbank::fuzz
