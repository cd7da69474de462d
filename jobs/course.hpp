#pragma once
// What commands that take minutes say of their work: in the person's words, with the share done and the time
// left. The shares are those that the stages took of the example's time; another plant's differ, so the time
// left is told as "about".
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
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
    {"first steps ", "quick fits of second effects", 0.95, 0.97, true, " beside"},
    {"fit ", "full fits of the best second effects", 0.95, 0.97, true, " beside"},
    {"in place of", "pairs of other effects are tried", 0.95, 0.97, true, " + "},
    {"crossed", "partners are exchanged between pairs", 0.95, 0.97, true, " + "},
    {"unseen events", "pairs are judged on events they were not fitted to", 0.95, 0.97, true, " + "},
    {"base", "the model's parameters are refitted", 0, 0.01},
    {"parameter", "a few wrong parameters are tried", 0.01, 0.015},
    {"missing input", "the missing input is inferred", 0.015, 0.02},
    {"hypotheses", "effects are screened", 0.02, 0.05},
    {"first steps ", "quick fits", 0.05, 0.26},
    {"fit ", "full fits of the best candidates", 0.26, 0.4},
    {"noise measured again", "the noise is measured again", 0.4, 0.48},
    {"further starts", "competing hypotheses from further starts", 0.48, 0.74},
    {"other optima", "competing hypotheses from distant starts", 0.74, 0.89},
    {"unseen events", "effects are judged on events they were not fitted to", 0.89, 0.97},
    {"law", "user-defined models are searched", 0.89, 0.97},
});
/// With two events of the same (5 s each).
inline const Course kCalibrateCourse = then_played({
    {"events with the model as it is", "the model as it is", 0, 0.15},
    {"parameter sets screened", "parameter sets are screened", 0.15, 0.2},
    {"starts refined", "parameters are fitted", 0.2, 0.62},
    {"noise of the voltage", "the noise of the voltage is corrected", 0.62, 0.8},
    {"events with the fitted model", "the fitted model", 0.8, 0.82},
    {"sensitivities", "what the records determine", 0.82, 0.95},
});
inline const Course kAddCourse = then_played({
    {"events with the model as it is", "the model as it is", 0, 0.04},
    {"values of", "values of the effect are screened", 0.04, 0.25},
    {"starts of", "the effect is fitted", 0.25, 0.55},
    {"noise measured again", "the noise is measured again", 0.55, 0.57},
    {"events without the effect", "the model without the effect", 0.57, 0.8},
    {"events with the effect", "the model with the effect", 0.8, 0.85},
    {"sensitivities", "what the records determine", 0.85, 0.95},
});

/// Of calibrate --fewest, with twelve events of a unit with four controls behind its transformer (480 s).
inline const Course kFewestCourse = then_played({
    {"every parameter", "all parameters are fitted", 0, 0.12},
    {"without", "what each wrong parameter reduces", 0.75, 0.98},
    {"sets of parameters", "sets of wrong parameters are tried", 0.12, 0.75},
});

/// Progress through a course. Neither the share done nor the time left that it prints ever goes back.
class CourseProgress {
 public:
  explicit CourseProgress(Course course) : course_(std::move(course)) {}
  /// "37 % done, about 1 min 20 s left: quick fits (SEXS, 16 of 26)". A stage that the course
  /// does not know is printed by its own name. A stage that begins again is counted: "round 2".
  std::string line(const std::string& what, int done, int total, double seconds) {
    const auto stage = std::ranges::find_if(course_, [&](const CourseStage& s) { return s.is(what); });
    if (stage == course_.end()) return fmt::format("{}: {} of {}", what, done, total);
    const double part = total > 0 ? static_cast<double>(done) / total : 0;
    share_ = std::max(share_, stage->from + (stage->to - stage->from) * part);
    beyond_ = beyond_ || stage->beyond;
    const std::string text =
        beyond_ ? std::string("beyond the usual course") : fmt::format("{:.0f} % done", 100 * share_);
    std::string item = what.starts_with(stage->inner) ? what.substr(stage->inner.size()) : what;
    item.erase(0, item.find_first_not_of(' '));
    const int round = round_of(static_cast<std::size_t>(stage - course_.begin()), done);
    return text + time_left(seconds) +
           fmt::format(": {} ({}{} of {}{})", stage->words, item.empty() ? "" : item + ", ", done, total,
                       round > 1 ? fmt::format(", round {}", round) : "");
  }

 private:
  struct Seen {
    int done = 0, rounds = 1;
  };
  /// How often the stage was begun: its counter starts again where the work repeats it.
  int round_of(std::size_t stage, int done) {
    const auto [seen, first] = seen_.try_emplace(stage);
    if (!first && done <= seen->second.done && done <= 1 && seen->second.done > 1) ++seen->second.rounds;
    seen->second.done = done;
    return seen->second.rounds;
  }
  /// ", about 1 min 20 s left"; nothing where the work takes longer than was said before, because a time that
  /// grows helps nobody.
  std::string time_left(double seconds) {
    if (beyond_ || share_ < kLeastDone || share_ >= 1) return "";
    const double end = seconds / share_;
    if (end > end_ * kMayGrow) return "";
    end_ = std::min(end_, end);
    const double left = std::max(end_ - seconds, 0.0);
    return left > 0 ? fmt::format(", about {} left", duration_text(left)) : "";
  }

  static constexpr double kLeastDone = 0.02;  ///< below it, the rate so far predicts nothing
  static constexpr double kMayGrow = 1.2;     ///< of the duration first told
  Course course_;
  std::map<std::size_t, Seen> seen_;
  double share_ = 0;
  double end_ = std::numeric_limits<double>::infinity();  ///< duration of the whole, as told [s]
  bool beyond_ = false;
};

}  // namespace swingbank::jobs
