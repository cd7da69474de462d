#pragma once
// What made a result beside its data and settings.
namespace swingbank::train::run {

/// "swingbank 0.1.0, code 1a2b3c": version, and a hash of the sources of train and sim/direct without
/// comments and blanks.
const char* software();

}  // namespace swingbank::train::run
