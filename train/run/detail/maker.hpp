#pragma once
// Software identification of a result.
namespace swingbank::train::run {

/// Returns "swingbank 0.2.0, code 1a2b3c": version, and a hash of the sources of train and sim/direct without
/// comments and blanks.
const char* software();

}  // namespace swingbank::train::run
