#pragma once
// The verdict in one word and one sentence.
#include "validate/calibrate/wrong_parameters.hpp"
#include "validate/diagnose/diagnose.hpp"

namespace swingbank::validate::diagnose {

/// Fills verdict, side, sentence, effects and their rivals from base, inputs and ranking, all of which are
/// judged. Searches for laws where neither the model nor a known effect explains the records.
void settle(const laws::Unexplained& judged, const event::Progress& progress, Diagnosis& d);

/// The verdict where a person has ended the work: what was fitted until then, and that it is not judged.
void interrupt(Diagnosis& d);

/// What is left of the refitted model, before anything else is known.
std::string first_sentence(const Diagnosis& d, double adequate);
/// Which few parameters are wrong and explain the records by themselves.
std::string wrong_sentence(const Diagnosis& d);
/// The same with table and JSON; for none where no few are.
std::optional<calibrate::WrongParameters> wrong_parameters(const Diagnosis& d);
/// On which side something is missing, by the inputs that are free in time.
std::string side_sentence(const Diagnosis& d);
/// Who leads once hypotheses were fitted.
std::string leading_sentence(const Diagnosis& d);

}  // namespace swingbank::validate::diagnose
