#pragma once
// Sources of the effects' numbers: cited works, and `derived` and `own` for numbers without a cited work. A
// number's source is written as a function call: cim("ExcSEXS") or own("twice the rating").
#include <string>
#include <string_view>

namespace swingbank::sim {

struct Work;

/// A work and the place in it. For `derived`, `own` and `user_model` the place is the reason as text.
struct Source {
  const Work* work = nullptr;  ///< cited work; null: no source was given
  std::string_view place;      ///< place in the work, or the reason
  /// Whether a source with a place was given.
  [[nodiscard]] constexpr bool given() const { return work && !place.empty(); }
};

/// A cited work.
struct Work {
  std::string_view id, author, edition, title, where;  ///< edition: year, version or commit
  /// Returns the citation of a place in the work.
  constexpr Source operator()(std::string_view place) const { return {this, place}; }
  /// Whether it is a publication, not one of `derived`, `own` and `user_model`.
  [[nodiscard]] constexpr bool published() const { return !title.empty(); }
};

/// Returns the source as text, such as "CIM: ExcSEXS", or only the place if the work has no id.
inline std::string as_text(const Source& source) {
  const std::string place(source.place);
  return source.work->id.empty() ? place : std::string(source.work->id) + ": " + place;
}

namespace literature {

/// The number follows from the equations, from the scope of the model or from the definition of the quantity.
inline constexpr Work derived{"derived", "", "", "", ""};
/// Swingbank's own choice, for the reason given.
inline constexpr Work own{"own choice", "", "", "", ""};
/// The source that a user-defined model gives for its numbers.
inline constexpr Work user_model{"", "", "", "", ""};

inline constexpr Work kundur{"Kundur", "P. Kundur", "1994", "Power System Stability and Control",
                             "McGraw-Hill"};
inline constexpr Work task_force{"IEEE Task Force", "IEEE Task Force on Load Representation", "1995",
                                 "Standard load models for power flow and dynamic performance simulation",
                                 "IEEE Trans. Power Syst. 10 (3), 1302"};
inline constexpr Work c37{"IEEE C37.118.1", "IEEE", "2011", "Synchrophasor Measurements for Power Systems",
                          "IEEE Standards"};
inline constexpr Work psse{"PSS/E", "Siemens PTI", "32 to 35", "Program Operation Manual and Model Library",
                           "with the program"};
inline constexpr Work cim{"CIM", "IEC and ENTSO-E", "CGMES 2.4.15",
                          "Dynamics profile (IEC 61970-302): typical values of the standard models",
                          "class comments in github.com/sogno-platform/cimpy, commit 0678496"};
inline constexpr Work sienna{"PowerSystems.jl", "NREL", "1.8", "Validation ranges of the PSS/E models",
                             "github.com/NREL-Sienna/PowerSystems.jl, src/models/generated"};
inline constexpr Work andes{"ANDES", "CURENT", "1.x", "Default values of the PSS/E models",
                            "github.com/CURENT/andes, andes/models"};

// Case files: .dyr files and PSS/E models of public projects.
inline constexpr Work psid{"PowerSimulationsDynamics.jl", "NREL", "d94d74e", "PSS/E test cases",
                           "github.com/NREL-Sienna/PowerSimulationsDynamics.jl, test/benchmarks/psse"};
inline constexpr Work openipsl{"OpenIPSL", "ALSETLab", "fe8aa5c", "Single-machine tests of the PSS/E models",
                               "github.com/OpenIPSL/OpenIPSL"};
inline constexpr Work gridpack{"GridPACK", "PNNL", "bea5ce1", "Case files", "github.com/GridOPTICS/GridPACK"};
inline constexpr Work griddyn{"GridDyn", "LLNL", "96b5751", "Case files", "github.com/LLNL/GridDyn"};
inline constexpr Work steps{"STEPS", "Changgang Li", "e5579d2", "Case files", "github.com/changgang/steps"};
inline constexpr Work powerful_cases{"PowerfulCases", "Hantao Cui", "b44f5d5", "Case files",
                                     "github.com/cuihantao/PowerfulCases"};
inline constexpr Work interpss{"InterPSS", "InterPSS-Project", "529b98f", "PSS/E test cases",
                               "github.com/InterPSS-Project/ipss-plugin"};

}  // namespace literature
}  // namespace swingbank::sim
