#pragma once
// A record compared as fits see it: no record says when between two samples the network changed, and a few
// milliseconds decide how far the rotor is thrown.
#include "validate/compare/compare.hpp"

namespace swingbank::validate::compare {

/// How instants and start are fitted. Noise is white, or what the plant makes of the voltage's noise is
/// counted too: behind a regulator that integrates it moves P and Q by many times their own noise, and taken
/// for white it would decide where the instants go.
enum class Fitted {
  in_white_noise,
  in_slow_noise,
  start_stands  ///< the start is the steady state before the event; noise is white
};

/// Sets switchings, playback and left_out of an event whose record is set. Its instants and its start are
/// fitted, and the model stays as it is. Samples that a filter has smeared over a jump are not played in.
/// Throws InputError where the model cannot follow the record.
void play_fitted(const plant::PlantModel& model, const CompareOptions& options, event::Jumps jumps,
                 Fitted how, EventComparison& e);

/// Sets EventComparison::doubt of an event that was played in by its voltage.
void add_doubt(const plant::PlantModel& model, EventComparison& e);

}  // namespace swingbank::validate::compare
