#pragma once
// Verdict of a diagnosis and its sentences.
#include "validate/calibrate/wrong_parameters.hpp"
#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

constexpr double kShownFrom = 0.01;           ///< minimum probability in texts, except in the credible set
constexpr std::size_t kHypothesesShown = 12;  ///< maximum number in text and chart; the page's table has all

/// Sets verdict, side, sentence, effects and their competitors from the fit of the given model, the inferred
/// inputs and the judged hypotheses. Searches for a user-defined model if no known effect explains the
/// records.
void settle(const user_model_search::Unexplained& judged, const event::Progress& progress, Diagnosis& d);

/// Sets the verdict of an interrupted diagnosis: completed fits are kept, and no hypothesis is judged.
void interrupt(Diagnosis& d);

/// Returns a note on how evidence is converted to the probabilities of the explanations.
std::string tempering_note();

/// Returns the first preliminary result: the residual of the refitted model.
std::string first_sentence(const Diagnosis& d, double adequate);
/// Returns the preliminary result with the small set of wrong parameters that explains the records.
std::string wrong_sentence(const Diagnosis& d);
/// Returns the small set of wrong parameters for table and JSON; empty if there is none.
std::optional<calibrate::WrongParameters> wrong_parameters(const Diagnosis& d);
/// Returns the preliminary result on the side at fault, from the inferred inputs.
std::string side_sentence(const Diagnosis& d);
/// Returns the preliminary result with the leading hypotheses after their fits.
std::string leading_sentence(const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
