#pragma once
// Parts that the reports of all commands share. Their order is: first screen, limits, usability, error maps,
// hypotheses, charts of the events, model information, parameters, errors, glossary, signatures, provenance.
#include <optional>
#include <string>
#include <vector>

#include "validate/compare/event_use.hpp"
#include "validate/compare/handed_in.hpp"
#include "validate/compare/played.hpp"
#include "validate/report/document.hpp"

namespace swingbank::validate::compare {

/// Value of a parameter before and after a command.
struct PageParameter {
  std::string block, symbol, unit;                  ///< block and symbol of the parameter; its unit
  double before = 0, after = 0, low = 0, high = 0;  ///< low, high: 95 % interval; NaN: not estimated
  double decided = 0;                               ///< variance reduction by the records; NaN: not estimated
  std::string note = {};                            ///< "at its bound"
};

/// Errors of the last model with their limits, and the verdict on each other model.
void limits_part(report::Document& page, const std::vector<Played>& played);
/// Charts of each event, collapsed: V, f, P and Q, measured and simulated by each model; then other recorded
/// channels. P and Q of the worst event are omitted, because the first screen shows them.
void panels_part(report::Document& page, const std::vector<Played>& played);
/// Table of parameters: before, after, 95 % interval. Without intervals (compare): the model's values.
void parameters_part(report::Document& page, const std::vector<PageParameter>& parameters);
/// Table of error_table().
void errors_part(report::Document& page, const std::vector<Played>& played, const EventUse& use = {});
/// Error map of map_table() or worst_map_table() as a heat map for each channel, side by side.
void heat_maps(report::Document& page, const report::Table& map);
/// Error map of each model.
void maps_part(report::Document& page, const std::vector<Played>& played);
/// Definitions of the terms on the page.
void glossary_part(report::Document& page);

/// Content of a page that consists of the shared parts only; `tried` is its list of hypotheses.
struct CommandPage {
  std::string title, subtitle;             ///< heading; line below it
  std::string headline = {};               ///< verdict in at most eight words; empty: that of headline()
  std::string next = {};                   ///< next command; empty: none
  bool complete = false;                   ///< statistically complete: the residual is noise
  bool noise_alone = true;                 ///< every event is within the limit of noise alone
  std::string sentence;                    ///< verdict in words
  std::vector<Played> played;              ///< models with their comparisons, in order
  std::vector<PageParameter> parameters;   ///< table of parameters; may be empty
  EventUse use = {};                       ///< events of the fit and of its verification
  std::vector<std::string> tried;          ///< tried hypotheses
  std::optional<HandedIn> handed_in = {};  ///< submitted model; none: no nameplate and no usability
  bool signatures = false;                 ///< blank lines for owner and reviewer in print
  report::Provenance provenance;           ///< inputs and software of the run
  std::string figures;                     ///< JSON of the results, embedded in the page
};
/// Returns the page's verdict in at most eight words.
std::string headline_of(const CommandPage& page);
/// Returns the page as HTML.
std::string command_html(const CommandPage& page);

}  // namespace swingbank::validate::compare
