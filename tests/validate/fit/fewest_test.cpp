// Sparse parameter selection: finds the wrong parameters and no others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "sim/library/library.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/fit/sparse_selection.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::validate::fit {
namespace {

/// The example's plant with its exciter, whose true values are known, and its records.
struct Known {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  noise::WhitenedEvents events;
  Known(const std::vector<std::pair<std::string, double>>& wrong, int records) {
    model.plant.controls.push_back({sim::library::compiled().find("SEXS"), {0.1, 10, 100, 0.05, -4.0, 5.0}});
    std::vector<record::Record> all;
    for (int k = 1; k <= records; ++k)
      all.push_back(record::read_record(
          test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", k)), model.record_base));
    for (const auto& [name, factor] : wrong)
      for (const auto& f : free())
        if (sim::plant::parameter_name(model.plant, f.id).text() == name)
          sim::plant::parameter_value(model.plant, f.id) *= factor;
    events = noise::whitened_events(model, all, {.measured_states = false});
  }
  [[nodiscard]] std::vector<FreeParameter> free() const { return free_parameters(model.plant, 0.2); }
  /// Names of the selected parameters, in alphabetical order.
  [[nodiscard]] std::vector<std::string> named(const SparseOptions& options = {}) const {
    const SparseSelection found = select_parameters(model.under_test(), events, free(), options);
    std::vector<std::string> names;
    for (const auto& w : found.wrong) {
      names.push_back(w.fit.full_name());
      EXPECT_GT(w.evidence, 10) << names.back();
      EXPECT_GT(w.fit.error, 0) << names.back();
    }
    EXPECT_LT(found.fit.reduced_chi2(), 1.12);
    std::ranges::sort(names);
    return names;
  }
};

TEST(SparseSelection, SelectsTheWrongParameter) {
  EXPECT_EQ(Known({{"GENROU.H", 1.3}}, 2).named(), std::vector<std::string>{"GENROU.H"});
}
/// An error of one per cent has significant evidence here. It is selected only if exact values are required.
TEST(SparseSelection, AcceptsErrorOfOnePerCent) {
  const Known known({{"GENROU.H", 1.3}, {"GENROU.Xdp", 1.01}}, 2);
  EXPECT_EQ(known.named(), std::vector<std::string>{"GENROU.H"});
  EXPECT_EQ(known.named({.right = 1e-6}), (std::vector<std::string>{"GENROU.H", "GENROU.Xdp"}));
}
TEST(SparseSelection, SelectsNothing_WhenAllValuesAreRight) { EXPECT_TRUE(Known({}, 2).named().empty()); }

/// Unit 2 of IEEE 14 modified by `change`, and the record of one fault.
std::pair<plant::PlantModel, noise::WhitenedEvents> unit_behind_a_fault(
    const std::function<void(sim::grid::Grid&)>& change) {
  const auto run =
      test::simulate("ieee14_genrou", sim::Conventions::psse(), 5, 2.0, 2.1, 240, {0.0, 0.1}, change);
  const auto at = std::ranges::find(run.grid.plants, "2", &sim::plant::Plant::name) - run.grid.plants.begin();
  plant::PlantModel model;
  model.plant = run.grid.plants[static_cast<std::size_t>(at)];
  model.plant.bus = model.plant.generator = -1;
  model.conventions = sim::Conventions::psse();
  model.record_base.mva = model.plant.mva;
  auto events = noise::whitened_events(model, {test::record_of(run, static_cast<int>(at), 4, 1e-3)},
                                       {.measured_states = false});
  return {std::move(model), std::move(events)};
}

/// A unit with ESST4B whose inner regulator is a pure gain KPM (KIM = 0). In the model both gains of the
/// outer regulator are too low by the same factor, so an increase of KPM has the same effect.
TEST(SparseSelection, ReportsThatTwoParametersReplaceOne) {
  const auto exciter = [](sim::grid::Grid& grid) {
    const sim::Effect& esst4b = *sim::library::compiled().find("ESST4B");
    sim::plant::Block block{&esst4b, esst4b.default_parameters()};
    for (const char* limit : {"VRMAX", "VRMIN", "VMMAX", "VMMIN"})  // far away: the equivalence is exact
      block.p[static_cast<std::size_t>(esst4b.parameter_index(limit))] *= 50;
    std::ranges::find(grid.plants, "2", &sim::plant::Plant::name)->controls.push_back(std::move(block));
  };
  auto [model, events] = unit_behind_a_fault(exciter);
  std::vector<FreeParameter> free;
  for (const FreeParameter& f : free_parameters(model.plant, 0.5)) {
    const std::string name = sim::plant::parameter_name(model.plant, f.id).text();
    if (name == "ESST4B.KPR" || name == "ESST4B.KIR") sim::plant::parameter_value(model.plant, f.id) *= 0.6;
    if (name.starts_with("ESST4B.K") || name == "GENROU.H") free.push_back(f);
  }
  const SparseSelection found = select_parameters(model.under_test(), events, free);
  ASSERT_EQ(found.wrong.size(), 1U);
  EXPECT_EQ(found.wrong[0].fit.full_name(), "ESST4B.KPM");
  ASSERT_EQ(found.alternatives.size(), 1U);
  EXPECT_EQ(found.alternatives[0].named, std::vector<std::string>{"ESST4B.KPM"});
  EXPECT_EQ(found.alternatives[0].instead, (std::vector<std::string>{"ESST4B.KPR", "ESST4B.KIR"}));
}

/// The ceiling is never reached at its prior mean, which is 20 % too high. The cost there equals that of a
/// ceiling that is just not reached.
TEST(SparseSelection, SelectsLimitThatThePriorMeanNeverReaches) {
  const sim::Effect& sexs = *sim::library::compiled().find("SEXS");
  const auto exciter = [&](sim::grid::Grid& grid) {
    std::ranges::find(grid.plants, "2", &sim::plant::Plant::name)
        ->controls.push_back({&sexs, {0.1, 10, 20, 0.05, -4.0, 2.6}});
  };
  auto [model, events] = unit_behind_a_fault(exciter);
  const int ceiling = sexs.parameter_index("EMAX");
  const auto free = free_parameters(model.plant, 0.2);
  FitOptions from{.lenient = true, .values = values_of(model.plant, free)};
  model.plant.controls.back().p[static_cast<std::size_t>(ceiling)] *= 1.2;
  const Fit all = fit(model.under_test(), events, free, from);
  const SparseSelection found = select_parameters(model.under_test(), events, free, {.all = &all});
  ASSERT_EQ(found.wrong.size(), 1U);
  EXPECT_EQ(found.wrong[0].fit.full_name(), "SEXS.EMAX");
}

TEST(SparseSelectionFull, SelectsThreeWrongParameters) {
  for (const auto& wrong : std::vector<std::vector<std::pair<std::string, double>>>{
           {{"GENROU.H", 1.3}, {"GENROU.Xdp", 0.8}, {"SEXS.K", 0.7}},
           {{"GENROU.Tdop", 1.3}, {"GENROU.Xq", 0.7}, {"SEXS.TB", 1.3}},
           {{"GENROU.H", 0.7}, {"GENROU.Xd", 1.3}, {"SEXS.TE", 1.3}}}) {
    std::vector<std::string> names;
    for (const auto& w : wrong) names.push_back(w.first);
    std::ranges::sort(names);
    EXPECT_EQ(Known(wrong, 2).named(), names);
  }
}

}  // namespace
}  // namespace swingbank::validate::fit
