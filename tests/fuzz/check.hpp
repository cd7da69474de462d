#pragma once
// What must hold after bytes were read without an error: everything computed from them is finite, or refused
// with a sentence.
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

namespace swingbank::fuzz {

/// Stops the fuzzer here with a stack trace.
[[noreturn]] inline void fail(const char* what) {
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}
inline void require(bool holds, const char* what) {
  if (!holds) fail(what);
}

/// Runs `action`; an InputError must carry at least one sentence, every part of it filled.
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

/// The power flow of a network is finite or refused. Larger networks take too long here.
inline void check_power_flow(const sim::network::Network& network) {
  if (network.buses.size() > 60) return;
  sim::network::PowerFlow flow;
  if (!accepted([&] { flow = sim::network::solve_power_flow(network); })) return;
  for (const Complex& v : flow.voltage) require(finite(v), "voltages are finite");
  for (const Complex& s : flow.generation) require(finite(s), "generation is finite");
}

/// What can be written reads back as it was.
inline void check_round_trip(const sim::network::Network& network) {
  for (const int version : {33, 35}) {
    std::string once;
    if (!accepted([&] { once = sim::formats::raw_text(network, version, "written"); })) return;
    sim::network::Network again;
    require(accepted([&] { again = sim::formats::parse_raw(once, "written"); }),
            "what was written can be read");
    require(sim::formats::raw_text(again, version, "again") == once, "a second round trip changes nothing");
  }
}

/// Reads a network with equipment that appears twice refused, and left out; `read` takes the options. True
/// with `lenient` filled if it is read in the latter way; `whole`: in the former, which then fills `strict`.
template <class Read>
bool read_both_ways(const Read& read, sim::formats::RawOptions options, sim::network::Network& strict,
                    sim::network::Network& lenient, bool& whole) {
  options.drop_refused = false;
  whole = accepted([&] { strict = read(options); });
  options.drop_refused = true;
  if (accepted([&] { lenient = read(options); })) return true;
  require(!whole, "what is whole is read with either option");
  return false;
}

inline void quiet() { spdlog::set_level(spdlog::level::off); }

}  // namespace swingbank::fuzz
