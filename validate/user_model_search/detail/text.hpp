#pragma once
// TOML file and description of a user-defined model.
#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// Returns an identifier, for example "TORQUE_LIMITED_SPEED".
std::string user_model_name(const UserModelCandidate& user_model);
/// Returns the TOML file (docs/how-to/add-an-effect.md). The candidate's parameter values are the default
/// values in the file.
std::string user_model_toml(const UserModelCandidate& user_model, const std::string& source);
/// Returns for example "a torque of 0.021 pu (0.02 to 0.022) × the speed deviation"; intervals are those of
/// `fitted`.
std::string user_model_words(const UserModelCandidate& user_model,
                             const std::vector<fit::FittedParameter>& fitted = {});

}  // namespace swingbank::validate::user_model_search
