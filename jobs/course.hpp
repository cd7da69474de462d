#pragma once
// What commands that take minutes say of their work: in the person's words, with the share done and the time
// left. The shares are those that the stages took of the example's time; another plant's differ, so the time
// left is told as "about".
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.hpp"

namespace swingbank::jobs {

/// One stage of a course.
struct CourseStage {
  std::string_view inner;      ///< what the work calls it; the first stage whose words it holds is meant
  std::string_view words;      ///< as a person reads it
  double from, to;             ///< share of the whole time at its begin and end
  bool beyond = false;         ///< comes only where the rest did not do, and may take longer than it
  std::string_view also = {};  ///< a second word that it must hold
  [[nodiscard]] bool is(const std::string& what) const {
    return what.find(inner) != std::string::npos && what.find(also) != std::string::npos;
  }
};
using Course = std::vector<CourseStage>;
/// The course with what every command ends with: its models' events are played for the page.
inline Course then_played(Course course) {
  const double from = std::ranges::max(course, {}, &CourseStage::to).to;
  for (const std::string_view inner : {": the voltage", ": instants", ": what is left", ": compared"})
    course.push_back({inner, "the models' events are played", from, 1});
  return course;
}

/// Measured on two shared cores with the four events of configs/records/record-example (34 s, of which 6 s
/// beyond the usual course).
inline const Course kDiagnoseCourse = then_played({
    {"hypotheses", "second effects are screened", 0.95, 0.97, true, " beside"},
    {"first steps ", "second effects are tried in brief", 0.95, 0.97, true, " beside"},
    {"fit ", "promising second effects are fitted", 0.95, 0.97, true, " beside"},
    {"in place of", "pairs of other effects are tried", 0.95, 0.97, true, " + "},
    {"crossed", "partners are exchanged between pairs", 0.95, 0.97, true, " + "},
    {"unseen events", "pairs are judged on events they were not fitted to", 0.95, 0.97, true, " + "},
    {"base", "the model's parameters are refitted", 0, 0.01},
    {"parameter", "a few wrong parameters are tried", 0.01, 0.015},
    {"missing input", "the missing input is inferred", 0.015, 0.02},
    {"hypotheses", "effects are screened", 0.02, 0.05},
    {"first steps ", "effects are tried in brief", 0.05, 0.26},
    {"fit ", "promising effects are fitted", 0.26, 0.4},
    {"noise measured again", "the noise is measured again", 0.4, 0.48},
    {"further starts", "rivals get further starts", 0.48, 0.74},
    {"other optima", "rivals are fitted from far away", 0.74, 0.89},
    {"unseen events", "effects are judged on events they were not fitted to", 0.89, 0.97},
    {"law", "laws are looked for", 0.89, 0.97},
});
/// With two events of the same (5 s each).
inline const Course kCalibrateCourse = then_played({
    {"events with the model as it is", "the model as it is", 0, 0.15},
    {"parameter sets screened", "parameter sets are screened", 0.15, 0.2},
    {"starts refined", "parameters are fitted", 0.2, 0.62},
    {"noise of the voltage", "the voltage's noise is taken back", 0.62, 0.8},
    {"events with the fitted model", "the fitted model", 0.8, 0.82},
    {"sensitivities", "what the records decide", 0.82, 0.95},
});
inline const Course kAddCourse = then_played({
    {"events with the model as it is", "the model as it is", 0, 0.04},
    {"values of", "values of the effect are screened", 0.04, 0.25},
    {"starts of", "the effect is fitted", 0.25, 0.55},
    {"noise measured again", "the noise is measured again", 0.55, 0.57},
    {"events without the effect", "the model without the effect", 0.57, 0.8},
    {"events with the effect", "the model with the effect", 0.8, 0.85},
    {"sensitivities", "what the records decide", 0.85, 0.95},
});

/// Of calibrate --fewest, with twelve events of a unit with four controls behind its transformer (480 s).
inline const Course kFewestCourse = then_played({
    {"every parameter", "all parameters are fitted", 0, 0.12},
    {"without", "what each wrong parameter takes away", 0.75, 0.98},
    {"sets of parameters", "sets of wrong parameters are tried", 0.12, 0.75},
});

/// Where the work stands; never goes back.
class CourseProgress {
 public:
  explicit CourseProgress(Course course) : course_(std::move(course)) {}
  /// "37 % done, about 1 min 20 s left: effects are tried in brief (SEXS: 16 of 26)". A course that does not
  /// know the stage tells it as it is called.
  std::string line(const std::string& what, int done, int total, double seconds) {
    const auto stage = std::ranges::find_if(course_, [&](const CourseStage& s) { return s.is(what); });
    const double part = total > 0 ? static_cast<double>(done) / total : 0;
    if (stage == course_.end()) return fmt::format("{}: {} of {}", what, done, total);
    share_ = std::max(share_, stage->from + (stage->to - stage->from) * part);
    beyond_ = beyond_ || stage->beyond;
    std::string text =
        beyond_ ? std::string("beyond the usual course") : fmt::format("{:.0f} % done", 100 * share_);
    if (!beyond_ && share_ >= 0.02 && share_ < 1)
      text += fmt::format(", about {} left", duration_text(seconds * (1 - share_) / share_));
    std::string item = what.starts_with(stage->inner) ? what.substr(stage->inner.size()) : what;
    item.erase(0, item.find_first_not_of(' '));
    return text +
           fmt::format(": {} ({}{} of {})", stage->words, item.empty() ? "" : item + ", ", done, total);
  }

 private:
  Course course_;
  double share_ = 0;
  bool beyond_ = false;
};

}  // namespace swingbank::jobs
