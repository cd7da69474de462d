#pragma once
// A law as a file and in words.
#include "validate/laws/candidate.hpp"

namespace swingbank::validate::laws {

/// "TORQUE_LIMITED_SPEED": an identifier.
std::string law_name(const LawCandidate& law);
/// The law file (docs/add-an-effect.md); the parameters' values stand in it as their standard values.
std::string law_toml(const LawCandidate& law, const std::string& source);
/// "a torque of 0.021 pu (0.02 to 0.022) × the speed deviation"; intervals where `fitted` has them.
std::string law_words(const LawCandidate& law, const std::vector<fit::FittedParameter>& fitted = {});

}  // namespace swingbank::validate::laws
