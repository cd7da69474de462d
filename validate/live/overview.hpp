#pragma once
// Content of the live page as JSON: sliders, events, verdict and errors of each step.
#include "validate/live/session.hpp"

namespace swingbank::validate::live {

/// Returns model, events and limits: everything that does not depend on a step.
nlohmann::json setup_json(const Setup& setup, const Step& submitted);
/// Returns a step: verdict, sliders, RMS error of each channel (chips), error maps and limits.
nlohmann::json step_json(const Setup& setup, const Step& step, int number);
/// Returns the curves of one event as 32-bit floats: the times [s], then the samples of each channel [unit of
/// the channel]. A channel has measured values, modelled values, and half widths of the 95 % band of the
/// modelled values (NaN: no band).
std::vector<float> curves(const Step& step, std::size_t event);
/// Returns a preview as 32-bit floats: RMS error, noise (both [unit]) and modelled samples of each channel.
std::vector<float> preview_floats(const Preview& preview, const compare::EventComparison& event);
/// Returns the responses with a parameter decreased and increased by 10 % of its value: for each channel, the
/// samples of both responses [unit of the channel]. A parameter at zero is changed by 10 % of its usual
/// range.
std::vector<float> ribbon(const Step& step, std::size_t event, const Values& values, const std::string& name);
/// Returns the effects that can be added to a step's model, in the order of the library.
nlohmann::json effects_json(const Step& step);

}  // namespace swingbank::validate::live
