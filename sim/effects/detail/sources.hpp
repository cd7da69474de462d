#pragma once
// Common references (literature, own choices) for the effects' default values and bounds. "The case files"
// are those of the works named in sim/core/literature.hpp: some 60 .dyr files, with more than 3,400 records
// of the compiled models.
#include "sim/core/literature.hpp"

namespace swingbank::sim::effects::shared {

// Bounds.
inline constexpr Source kBeyondCases = literature::own(
    "sign required by the equations; all values of the case files except 999 (none) lie inside");
inline constexpr Source kNoCases =
    literature::own("sign required by the equations; a wide range, because no case file has the model");
inline constexpr Source kShare = literature::derived("a fraction");
inline constexpr Source kCode = literature::derived("the defined codes");
inline constexpr Source kNotModelled = literature::derived("0 only: nothing else is modelled");
inline constexpr Source kDeadBand = literature::own("1.2 Hz of 60 Hz: wider than any governor's dead-band");
inline constexpr Source kBusNumber = literature::psse("bus numbers, up to 999997");
inline constexpr Source kThreshold =
    literature::own("above 0, because the load divides by it; at most rated voltage");
inline constexpr Source kFrequencyLag = literature::own("from half a cycle of 50 Hz to a second");
inline constexpr Source kBeyondKundur = literature::own(
    "at least 1.7 times beyond Kundur's tables 3.2 and 4.2; above 0 where the equations divide");
inline constexpr Source kDamping = literature::own("no negative damping; the case files reach 8");
inline constexpr Source kSaturation = literature::own("not negative; the case files reach 1.0 and 1.3");
inline constexpr Source kBeyondClass = literature::own("far beyond the worst accuracy class, 10 %");
inline constexpr Source kNoMeasurement =
    literature::own("a tenth of the quantity, or 1 Hz: larger errors make the measurement useless");
inline constexpr Source kAnyTime = literature::own("from 0, where a run begins, to longer than any record");
inline constexpr Source kRating = literature::own("not more than the rating");

// Defaults.
inline constexpr Source kNothing = literature::own("off by default");
inline constexpr Source kNeglected = literature::own("neglected; the default of ZR in PSS/E's .raw");
inline constexpr Source kPowerThreshold = literature::psse("PQBRAK, where constant power ends");
inline constexpr Source kCurrentThreshold = literature::psse("0.5 pu, where constant current ends");
inline constexpr Source kThreeCycles = literature::own("three cycles of 60 Hz");
inline constexpr Source kTwoAreas = literature::kundur("example 12.6, the two-area system");
inline constexpr Source kThermalInertia = literature::kundur("within table 3.2, thermal units");
inline constexpr Source kSlowDamper = literature::own("just above Kundur's 0.02 to 0.05 s (table 4.2)");
inline constexpr Source kMildSaturation = literature::psid("GAST/dyn_data.dyr");
inline constexpr Source kNever = literature::own("later than the end of any record shorter than a day");
inline constexpr Source kFewSeconds = literature::own("a few seconds");
inline constexpr Source kAfterRest = literature::own("start after one second of steady state");

}  // namespace swingbank::sim::effects::shared
