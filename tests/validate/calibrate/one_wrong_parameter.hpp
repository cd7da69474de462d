#pragma once
// A model with one wrong parameter, calibrated with all others fixed.
#include <gtest/gtest.h>

#include "validate/calibrate/calibrate.hpp"

namespace swingbank::validate::test {

/// Sets `parameter` ("SEXS.K") of the right model too high by `factor`. Only the parameters must be
/// judged poor, and the fit must find the value within four standard errors and within 10 % of the truth.
inline void expect_found(plant::PlantModel model, std::vector<record::Record> records,
                         const std::string& parameter, double factor) {
  model.record_base = records.front().base;
  Problems problems;
  std::vector<sim::plant::ParameterId> all;
  for (const auto& f : fit::free_parameters(model.plant, 0.3)) all.push_back(f.id);
  const auto wanted = sim::plant::find_parameters(model.plant, all, {parameter}, "test", "", problems);
  ASSERT_EQ(wanted.size(), 1u) << parameter;
  const double truth = sim::plant::parameter_value(model.plant, wanted.front());
  sim::plant::parameter_value(model.plant, wanted.front()) *= factor;
  calibrate::CalibrateOptions options;
  options.draws = options.starts = 0;
  for (const auto& id : all)
    if (id != wanted.front()) options.fixed.push_back(sim::plant::parameter_name(model.plant, id).text());
  const calibrate::Calibration c = calibrate::calibrate(model, std::move(records), options);
  EXPECT_EQ(c.adequacy, calibrate::Adequacy::parameters_poor) << parameter << ": " << c.sentence;
  const auto& fit = c.parameters.front().fit;
  EXPECT_NEAR(fit.value, truth, 4 * fit.error) << parameter;
  EXPECT_LT(fit.error, 0.1 * truth) << parameter;
}

}  // namespace swingbank::validate::test
