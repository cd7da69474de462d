#pragma once
// Definition of a user-defined model after reading: its metadata and its compiled program.
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/user_models/detail/program.hpp"

namespace swingbank::sim::user_models {

/// Coefficients of a user-defined model: [0] system frequency, then the parameters, unknowns of steady(),
/// values at the operating point, constants, and fixed values computed from these.
constexpr int kFrequency = 0, kFirstParameter = 1;

/// A condition on the parameters, checked by Effect::check.
struct Requirement {
  Op op;  ///< less or less_equal
  int left, right;
  std::string text, where;
};

/// Metadata and program of a user-defined model.
struct Definition {
  std::string text;  ///< unmodified content of the file
  std::string name, title, source, description;
  std::deque<std::string> texts;  ///< storage behind the string_views of parameters and states
  std::vector<Parameter> parameters;
  std::vector<State> states;
  Slot slot = Slot::shaft;
  int output = -1;  ///< index into kSignals
  bool replaces = false;
  std::vector<std::pair<int, int>> operating;  ///< coefficient and the signal whose initial value it contains
  std::vector<int> searched;                   ///< coefficients that steady() solves for
  std::vector<int> start;                      ///< per state: coefficient with the initial guess
  std::vector<Requirement> requirements;       ///< both sides are coefficients
  std::vector<int> switching_times;            ///< coefficients with switching times [s]
  std::vector<std::pair<int, std::string>>
      finite;  ///< coefficients that depend on parameters only, with their text; they must be finite
  Compiled code;

  /// Returns true if the operating point prescribes the output. The prescribed value is the machine's Efd or
  /// Tm; it is zero for dVref, dPref and a model that adds to Efd or Tm.
  [[nodiscard]] bool must_meet() const;
  [[nodiscard]] std::string_view output_name() const {
    return kSignals[static_cast<std::size_t>(output)].name;
  }
};

/// Reads a user-defined model. Throws InputError with all errors of the file.
Definition read_definition(const std::string& text, const std::filesystem::path& name);
/// Returns the effect that runs the definition.
Effect make_effect(Definition definition);

/// Fills c with parameters, constants, values at the operating point (if `s` is given, else NaN), and the
/// fixed values computed from these. c[kFrequency] is unchanged.
template <class T>
void fill(const Definition& user_model, const T* p, const Signals<T>* s, T* c) {
  for (std::size_t i = 0; i < user_model.parameters.size(); ++i)
    c[static_cast<std::size_t>(kFirstParameter) + i] = p[i];
  for (const auto& [index, value] : user_model.code.constants) c[index] = T(value);
  for (const auto& [index, signal] : user_model.operating)
    c[index] =
        s ? s->*kMembers<T>[static_cast<std::size_t>(signal)] : T(std::numeric_limits<double>::quiet_NaN());
  Registers<T> registers;
  T unused(0.0);
  run<T, false>(user_model.code.fixed, c, nullptr, Signals<T>{}, registers.data(), c, unused);
}

/// Computes the steady state: fills c, x and the user-defined model's output at the operating point. Returns
/// the reason why the operating point is infeasible, or "".
std::string steady(const Definition& user_model, const double* p, double* c, Signals<double>& s, double* x);
std::string steady(const Definition& user_model, const D8* p, D8* c, Signals<D8>& s, D8* x);

}  // namespace swingbank::sim::user_models
