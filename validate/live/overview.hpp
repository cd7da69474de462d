#pragma once
// Content of the live page as JSON: sliders, events, verdict and errors of each step.
#include "validate/live/session.hpp"

namespace swingbank::validate::live {

/// Returns model, events and limits: everything that does not depend on a step.
nlohmann::json setup_json(const Setup& setup, const Step& submitted);
/// Returns a step: verdict, sliders, chips, error maps and limits.
nlohmann::json step_json(const Setup& setup, const Step& step, int number);
/// Returns the curves of one event as 32-bit floats: t, then for each channel measured, modelled
/// and half width of the 95 % band of the modelled (NaN: none) [unit].
std::vector<float> curves(const Step& step, std::size_t event);
/// Returns a preview as 32-bit floats: RMS error, noise (both [unit]) and modelled samples of each channel.
std::vector<float> preview_floats(const Preview& preview, const compare::EventComparison& event);
/// Returns the response with a tenth less and a tenth more of a parameter than its value: for each channel
/// the samples of both [unit]. Of a parameter at zero, with a tenth of its usual range.
std::vector<float> ribbon(const Step& step, std::size_t event, const Values& values, const std::string& name);
/// Returns the effects that can be added to a step's model, in the order of the library.
nlohmann::json effects_json(const Step& step);

}  // namespace swingbank::validate::live
