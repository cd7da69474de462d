#pragma once
// TOML file and description of a user-defined model.
#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// Returns an identifier, for example "TORQUE_LIMITED_SPEED".
std::string law_name(const LawCandidate& law);
/// Returns the TOML file (docs/how-to/add-an-effect.md). The parameters' values are its default values.
std::string law_toml(const LawCandidate& law, const std::string& source);
/// Returns for example "a torque of 0.021 pu (0.02 to 0.022) × the speed deviation"; intervals are those of
/// `fitted`.
std::string law_words(const LawCandidate& law, const std::vector<fit::FittedParameter>& fitted = {});

}  // namespace swingbank::validate::user_model_search
