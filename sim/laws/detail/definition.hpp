#pragma once
// A law as it was read: its records and its program.
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/laws/detail/program.hpp"

namespace swingbank::sim::laws {

/// Coefficients of a law: [0] system frequency, then the parameters, values at the operating point, what
/// steady() searches, constants, and everything fixed that is computed from these.
constexpr int kFrequency = 0, kFirstParameter = 1;

struct Requirement {
  Op op;  ///< less or less_equal
  int left, right;
  std::string text, where;
};

struct Definition {
  std::string text;  ///< of the file, as it was read
  std::string name, title, source, description;
  std::deque<std::string> texts;  ///< what the records' string_views refer to
  std::vector<Parameter> parameters;
  std::vector<State> states;
  Slot slot = Slot::shaft;
  int output = -1;  ///< index into kSignals
  bool replaces = false;
  std::vector<std::pair<int, int>> operating;  ///< coefficient, signal whose value it keeps
  std::vector<int> searched;                   ///< coefficients that steady() finds
  std::vector<int> start;                      ///< per state: coefficient where the search begins
  std::vector<Requirement> requirements;       ///< sides: coefficients
  std::vector<int> instants;                   ///< coefficients [s]
  std::vector<std::pair<int, std::string>>
      finite;  ///< coefficients that follow from parameters alone, as text
  Compiled code;

  /// Whether the output must have a given value at the operating point: the machine's own Efd or Tm, or none
  /// at all where nothing else makes room for it.
  [[nodiscard]] bool must_meet() const;
  [[nodiscard]] std::string_view output_name() const {
    return kSignals[static_cast<std::size_t>(output)].name;
  }
};

/// Reads a law file. Throws InputError with all its faults.
Definition read_definition(const std::string& text, const std::filesystem::path& name);
/// The effect that runs it.
Effect make_effect(Definition definition);

/// Parameters, constants and (where `s` is given) values at the operating point into c, and all that is
/// fixed. c[kFrequency] is left as it is.
template <class T>
void fill(const Definition& law, const T* p, const Signals<T>* s, T* c) {
  for (std::size_t i = 0; i < law.parameters.size(); ++i)
    c[static_cast<std::size_t>(kFirstParameter) + i] = p[i];
  for (const auto& [index, value] : law.code.constants) c[index] = T(value);
  for (const auto& [index, signal] : law.operating)
    c[index] =
        s ? s->*kMembers<T>[static_cast<std::size_t>(signal)] : T(std::numeric_limits<double>::quiet_NaN());
  Registers<T> room;
  T unused(0.0);
  run<T, false>(law.code.fixed, c, nullptr, Signals<T>{}, room.data(), c, unused);
}

/// Fills c, x and what the law puts out at the operating point. Returns why it cannot be held, or "".
std::string steady(const Definition& law, const double* p, double* c, Signals<double>& s, double* x);
std::string steady(const Definition& law, const D8* p, D8* c, Signals<D8>& s, D8* x);

}  // namespace swingbank::sim::laws
