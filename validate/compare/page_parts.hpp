#pragma once
// The parts that the pages of all commands have, in the order in which they stand: verdict, error maps,
// panels of the events, parameters, errors, what was tried, glossary, provenance.
#include <string>
#include <vector>

#include "validate/compare/played.hpp"
#include "validate/report/page.hpp"

namespace swingbank::validate::compare {

/// A parameter before and after, by its symbol.
struct PageParameter {
  std::string block, symbol, unit;
  double before = 0, after = 0, low = 0, high = 0;  ///< 95 % interval; NaN: not estimated
  double decided = 0;                               ///< share that the records decide; NaN: not estimated
  std::string note = {};                            ///< "at its bound"
};

/// Both sentences, and the worst errors of the model that counts (the last one) beside their limits.
void verdict_part(report::Page& page, const std::vector<Played>& played, bool complete,
                  const std::string& sentence, report::Tone tone);
/// Of each event four panels, V, f, P and Q, measured and as each model answers; then what else was recorded.
void panels_part(report::Page& page, const std::vector<Played>& played);
/// Before, after, 95 % interval. Without intervals (compare) the values that the model has.
void parameters_part(report::Page& page, const std::vector<PageParameter>& parameters);
/// RMS, noise and their ratio of each event and channel (error_table). `unseen`: names of the events that
/// were not fitted to.
void errors_part(report::Page& page, const std::vector<Played>& played,
                 const std::vector<std::string>& unseen = {});
/// The error map of each model.
void maps_part(report::Page& page, const std::vector<Played>& played);
/// Definitions of the terms on the page.
void glossary_part(report::Page& page);

/// A page of a command that has no more to show: all parts, `tried` among them as sentences.
struct CommandPage {
  std::string title, subtitle;
  bool complete = false;
  std::string sentence;
  std::vector<Played> played;
  std::vector<PageParameter> parameters;
  std::vector<std::string> unseen, tried;
  report::Provenance provenance;
  std::string figures;  ///< JSON
};
std::string command_html(const CommandPage& page);

}  // namespace swingbank::validate::compare
