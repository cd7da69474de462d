#include "validate/live/session.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/shell_word.hpp"

namespace swingbank::validate::live {
namespace {

std::shared_ptr<const compare::Played> played(const Setup& setup, const plant::PlantModel& model,
                                              bool& complete, bool fit_switchings = true) {
  compare::CompareOptions options = setup.compare;
  options.fit_switchings = fit_switchings;
  if (setup.threads > 0) omp_set_num_threads(setup.threads);  // of this thread
  auto p = std::make_shared<compare::Played>(
      compare::play_and_judge("model", model, setup.measured, options, setup.by));
  if (p->events.empty())
    throw InputError({"the model cannot be simulated with the records", model.origin, p->fitness.not_judged,
                      "return to the previous values"});
  complete = compare::judge(p->events).adequate;
  for (auto& e : p->events) e.doubt.clear();  // large, and needed by the judgement only
  return p;
}

/// Returns "GENROU.H 6.54 → 5.2 s" for each changed value.
std::string label_of(const plant::PlantModel& before, const plant::PlantModel& after) {
  std::string text;
  for (int block = 0; block < sim::plant::block_count(before.plant); ++block)
    for (const auto id : sim::plant::parameters_of(before.plant, block)) {
      const double a = parameter_value(before.plant, id), b = parameter_value(after.plant, id);
      if (a == b) continue;
      const std::string_view unit = parameter_record(before.plant, id).unit;
      text += fmt::format("{}{} {:.4g} → {:.4g}{}", text.empty() ? "" : ", ",
                          parameter_name(before.plant, id).text(), a, b,
                          unit == "-" ? "" : " " + std::string(unit));
    }
  return text;
}

Step submitted(const Setup& setup, bool provisional) {
  Step s;
  s.label = "submitted model";
  s.model = setup.model;
  s.provisional = provisional;
  s.command = fmt::format("swingbank compare --model {}{}", shell_word(setup.plant_file), setup.options);
  s.played = played(setup, s.model, s.complete, !provisional);
  return s;
}

}  // namespace

Step submitted_step(const Setup& setup) { return submitted(setup, false); }
Step first_step(const Setup& setup) { return submitted(setup, true); }

sim::plant::ParameterId find_parameter(const sim::plant::Plant& plant, const std::string& name) {
  for (int block = 0; block < sim::plant::block_count(plant); ++block)
    for (const auto id : sim::plant::parameters_of(plant, block))
      if (parameter_name(plant, id).text() == name) return id;
  throw InputError(
      {"parameter " + name, "the live page", "the model has no such parameter", "reload the page"});
}

plant::PlantModel with_values(plant::PlantModel model, const Values& values) {
  Problems problems;
  for (const auto& [name, value] : values) {
    if (!std::isfinite(value))
      problems.add("parameter " + name, "the live page", "its value is not a finite number",
                   "enter a number");
    else
      parameter_value(model.plant, find_parameter(model.plant, name)) = value;
  }
  problems.raise();
  for (int k = 0; k < sim::plant::block_count(model.plant); ++k) {
    const auto& block = sim::plant::block_at(model.plant, k);
    const auto* user_model = block.effect->user_model.get();
    if (block.effect->check != nullptr)
      block.effect->check(user_model, block.p.data(), std::string(block.effect->name), problems);
  }
  problems.raise();
  return model;
}

Session::Session(std::shared_ptr<const Setup> setup, std::shared_ptr<const Step> submitted, std::size_t most)
    : setup_(std::move(setup)), most_(most), steps_{std::move(submitted)} {}

std::shared_ptr<const Step> Session::step(int number) const {
  const std::lock_guard guard(lock_);
  if (number < 0 || number >= static_cast<int>(steps_.size()) || !steps_[static_cast<std::size_t>(number)])
    throw InputError(
        {fmt::format("step {}", number), "the live page", "the session has no such step", "reload the page"});
  return steps_[static_cast<std::size_t>(number)];
}

int Session::steps() const {
  const std::lock_guard guard(lock_);
  return static_cast<int>(steps_.size());
}

std::vector<int> Session::kept() const {
  const std::lock_guard guard(lock_);
  std::vector<int> numbers;
  for (std::size_t k = 0; k < steps_.size(); ++k)
    if (steps_[k]) numbers.push_back(static_cast<int>(k));
  return numbers;
}

void Session::diagnosed(int step, std::string result) {
  const std::lock_guard guard(lock_);
  diagnoses_[step] = std::move(result);
}

std::string Session::diagnosis_of(int step) const {
  const std::lock_guard guard(lock_);
  const auto found = diagnoses_.find(step);
  return found == diagnoses_.end() ? std::string() : found->second;
}

int Session::put(std::shared_ptr<const Step> added) {
  const std::lock_guard guard(lock_);
  std::size_t held = 0;
  for (const auto& s : steps_) held += s ? 1 : 0;
  if (held >= most_) {  // drop the oldest manual change that no step builds on
    const auto used = [&](int number) {
      return added->parent == number ||
             std::ranges::any_of(steps_, [&](const auto& s) { return s && s->parent == number; });
    };
    for (std::size_t k = 1; k < steps_.size(); ++k)
      if (steps_[k] && steps_[k]->kind == Step::Kind::manual && !used(static_cast<int>(k))) {
        steps_[k].reset();
        break;
      }
  }
  steps_.push_back(std::move(added));
  return static_cast<int>(steps_.size()) - 1;
}

void Session::compared(std::shared_ptr<const Step> submitted) {
  const std::lock_guard guard(lock_);
  steps_.front() = std::move(submitted);
}

int Session::change(int from, const Values& values) {
  const auto base = step(from);
  auto s = std::make_shared<Step>();
  s->kind = Step::Kind::manual;
  s->parent = from;
  s->model = with_values(base->model, values);
  s->label = label_of(base->model, s->model);
  if (s->label.empty()) return from;
  s->fitted = base->fitted;
  s->held_out = base->held_out;
  s->played = played(*setup_, s->model, s->complete);
  s->command = fmt::format("swingbank compare --model model.toml{}", setup_->options);
  return put(std::move(s));
}

int Session::append(Step added) {
  auto s = std::make_shared<Step>(std::move(added));
  s->played = played(*setup_, s->model, s->complete);
  return put(std::move(s));
}

Preview preview(const Step& step, std::size_t event, const Values& values) {
  if (event >= step.played->events.size())
    throw InputError(
        {fmt::format("event {}", event), "the live page", "there is no such event", "reload the page"});
  const plant::PlantModel model = with_values(step.model, values);
  return {compare::replay(model.under_test(), step.played->events[event])};
}

}  // namespace swingbank::validate::live
