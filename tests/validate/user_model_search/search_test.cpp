// User-defined models for an inferred input that no known effect explains. They are ranked by the input's
// time series, written as files, found in records, and accepted only if they predict events outside the fit.
#include "validate/user_model_search/search.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "sim/user_models/user_model.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/noise/pre_event.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/voltage_steps.hpp"
#include "validate/user_model_search/detail/text.hpp"
#include "validate/user_model_search/detail/time_series.hpp"

namespace swingbank::validate::user_model_search {
namespace {

/// Two events as input of the search for user-defined models: a decaying swing, knots every 0.1 s from the
/// event on, and an input given by a function of the speed deviation and of time.
template <class F>
std::vector<UserModelTrace> traces_with(F input) {
  std::vector<UserModelTrace> all;
  for (const double size : {0.006, 0.003}) {
    UserModelTrace e;
    e.trigger = e.begin = size > 0.004 ? 2.0 : 1.5;  // [s]; record time and time since the event differ
    e.rest = size > 0.004 ? 0.4 : 0.7;
    const auto swing = [&](double t, double hertz, double phase) {
      const double tau = t - e.begin;
      return tau < 0 ? 0.0 : std::exp(-tau / 4) * std::sin(6.283185307 * hertz * tau + phase);
    };
    for (int k = 0; k <= 900; ++k) {
      const double t = k / 60.0;
      e.t.push_back(t);
      e.signal[0].push_back(size * swing(t, 1.1, 0));
      e.signal[1].push_back(t >= e.begin && t < e.begin + 0.1 ? -0.4 : 0.05 * swing(t, 1.1, 1.2));
      e.signal[2].push_back(0.3 * swing(t, 1.1, 1.5));
      e.signal[3].push_back(0.2 * swing(t, 1.1, 2.0));
      e.signal[4].push_back(0.1 * swing(t, 1.1, 2.5));
    }
    for (double t = e.begin; t < 15.0; t += 0.1) e.knots.push_back(t);
    for (const double t : e.knots)
      e.input.push_back(input(e, e.signal[0][static_cast<std::size_t>(std::lround(t * 60))], t));
    all.push_back(std::move(e));
  }
  return all;
}
double value_of(const UserModelCandidate& user_model, const std::string& name) {
  const auto p = std::ranges::find(user_model.parameters, name, &UserModelParameter::name);
  return p == user_model.parameters.end() ? std::numeric_limits<double>::quiet_NaN() : p->value;
}
constexpr double kLevel = 0.1;

TEST(UserModelCandidates, LimitedSpeedModelRanksFirst) {
  const auto traces = traces_with([](const UserModelTrace&, double speed, double) {
    return -0.02 * std::clamp(speed / 0.001, -1.0, 1.0);
  });
  const auto ranked = user_model_candidates(fit::InputKind::torque, traces, kLevel);
  ASSERT_FALSE(ranked.empty());
  const UserModelCandidate& best = ranked.front();
  EXPECT_EQ(best.signal, "speed");
  EXPECT_THAT(best.family, testing::AnyOf("limited", "curved"));
  const auto limited = std::ranges::find(ranked, "limited", &UserModelCandidate::family);
  ASSERT_NE(limited, ranked.end());
  EXPECT_EQ(limited->signal, "speed");
  // The search grid's widths are a factor of two apart. The limit L follows from least squares.
  EXPECT_NEAR(value_of(*limited, "L"), -0.02, 0.003);
  EXPECT_NEAR(std::log2(value_of(*limited, "w") / 0.001), 0.0, 1.0);
}
TEST(UserModelCandidates, FindsOscillationWithItsFrequency) {
  const auto traces = traces_with([](const UserModelTrace&, double, double t) {
    return t < 4 ? 0.0 : 0.01 * std::sin(6.283185307 * 0.47 * t + 0.3);
  });
  const auto best = user_model_candidates(fit::InputKind::torque, traces, kLevel).front();
  EXPECT_EQ(best.family, "periodic");
  EXPECT_EQ(best.signal, "time");  // not time since the event, which differs between the records
  EXPECT_NEAR(value_of(best, "f"), 0.47,
              0.005);  // a quarter of the frequency error that turns the phase by one cycle over the record
  EXPECT_NEAR(value_of(best, "A"), 0.01, 0.001);    // 10 %, because the true start is not on the search grid
  EXPECT_NEAR(value_of(best, "start"), 4.0, 0.25);  // half the step of the search grid
}
TEST(UserModelCandidates, PulseDelayCountsFromTheEvent) {
  const auto traces = traces_with([](const UserModelTrace& e, double, double t) {
    const double tau = t - e.trigger;
    return tau > 1.0 && tau < 2.5 ? 0.05 : 0.0;
  });
  const auto best = user_model_candidates(fit::InputKind::field, traces, kLevel).front();
  EXPECT_EQ(best.family, "pulse");
  EXPECT_EQ(best.signal, "time since the voltage deviation");
  // The knots of the inferred input are 0.1 s apart.
  EXPECT_NEAR(value_of(best, "delay"), 1.0, 0.1);
  EXPECT_NEAR(value_of(best, "length"), 1.5, 0.1);
  EXPECT_NEAR(value_of(best, "A"), 0.05, 0.005);
}
TEST(UserModelCandidates, NoVoltageTrigger_WhenTheVoltageIsConstant) {
  const auto traces = traces_with([](const UserModelTrace&, double speed, double) { return -5 * speed; });
  for (const auto& user_model : user_model_candidates(fit::InputKind::torque, traces, 0.0))
    EXPECT_NE(user_model.signal, "time since the voltage deviation") << user_model.family;
}

/// Every user-defined model file can be read, rests at the operating point, and has the output that was
/// ranked.
TEST(UserModelText, EveryFileReproducesTheRankedTimeSeries) {
  const auto traces = traces_with([](const UserModelTrace& e, double speed, double t) {
    return -3 * speed + (t > e.begin + 3 ? 0.02 * std::sin(2.3 * t)
                                         : 0.0);  // a feature for every user-defined model to fit
  });
  const UserModelRegression regression(traces);
  for (const fit::InputKind kind : {fit::InputKind::torque, fit::InputKind::field}) {
    const auto ranked = user_model_candidates(kind, traces, kLevel);
    EXPECT_GE(ranked.size(), 60u);
    for (const UserModelCandidate& user_model : ranked) {
      SCOPED_TRACE(user_model_name(user_model));
      const sim::Effect effect = sim::user_models::make_user_model(user_model_toml(user_model, "a \"test\""),
                                                                   user_model_name(user_model));
      EXPECT_EQ(effect.slot, kind == fit::InputKind::torque ? sim::Slot::shaft : sim::Slot::exciter);
      EXPECT_EQ(user_model_words(user_model).find('{'), std::string::npos) << user_model_words(user_model);
      std::vector<double> values;
      for (const auto& p : user_model.parameters) values.push_back(p.value);
      EXPECT_EQ(effect.default_parameters(), values);
      const auto time_series =
          regression.by_event(regression.at_knots(user_model_time_series(effect, values, kind, traces)));
      double difference = 0, size = 0;
      for (std::size_t e = 0; e < time_series.size(); ++e)
        for (std::size_t k = 0; k < time_series[e].size(); ++k) {
          difference += std::pow(time_series[e][k] - user_model.time_series[e][k], 2);
          size += std::pow(user_model.time_series[e][k], 2);
        }
      // The ranking evaluates a model at 20/s and puts a step at each of its edges; a trigger acts within
      // some 10 ms. A sawtooth above 1 Hz has many steps, so up to three tenths of its mean square may
      // differ.
      const bool wave = user_model.family.starts_with("periodic, ");
      // A user-defined model that explains almost nothing is never fitted. Its amplitudes are kept away from
      // zero, so its time series may differ.
      if (user_model.explained > 0.1) {
        EXPECT_LT(difference, (wave ? 0.3 : 0.05) * size) << user_model_toml(user_model, "test");
      }
    }
  }
}
TEST(UserModelText, NumbersHaveUnitAndInterval) {
  UserModelCandidate user_model;
  user_model.words = "{K} × the speed deviation (lagged by {T})";
  user_model.parameters = {{"K", "pu", -7.5, -10, 10, true, "gain"}, {"T", "s", 0.25, 0, 10, false, "lag"}};
  fit::FittedParameter K;
  K.name = "K";
  K.low = -8;
  K.high = -7;
  EXPECT_EQ(user_model_words(user_model, {K}),
            "a torque of -7.5 pu (-8 to -7) × the speed deviation (lagged by 0.25 s)");
}

/// Simulated records of the example's events: the plant's parameters are 10 % off, and it has an additional
/// input.
struct Case {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
  noise::WhitenedEvents events;
  fit::Fit base;
  std::vector<hypothesis::HeldOut> held_out;
  reduced::FreeInput torque, field;
  static constexpr double kPriorSd = thresholds::parameters.prior_sd,
                          kAdequate = thresholds::adequacy.reduced_chi2;

  template <class Change>
  Case(const std::vector<int>& numbers, const sim::Effect* user_model, Change change) {
    plant::PlantModel truth = model;
    for (const auto& f : fit::free_parameters(truth.plant, kPriorSd))
      sim::plant::parameter_value(truth.plant, f.id) *= 1 + 0.1 * std::sin(3.0 * f.id.index + 1);
    if (user_model) sim::plant::insert_block(truth.plant, {user_model, user_model->default_parameters()});
    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    std::vector<record::Record> records;
    for (const int i : numbers) {
      record::Record r = record::read_record(
          test::source(fmt::format("configs/records/record-example/avr_ev{}.csv", i)), model.record_base);
      const auto switchings = switching::detect_switchings(r);
      const playin::VoltageCurve curve(r, switchings);
      playin::PlaybackRun run{
          .plant = &truth.plant, .conventions = truth.conventions, .record = &r, .curve = &curve};
      run.start = playin::pre_event_point(r, switchings, 1.0);
      run.tolerance = 1e-8;
      change(i, run);
      const playin::Response response = playin::simulate_playback(run);
      r.P = response.of(playin::Output::P);
      r.Q = response.of(playin::Output::Q);
      for (auto* channel : {&r.P, &r.Q})
        for (double& v : *channel) v += 1e-3 * normal(generator);
      r.speed.clear();
      r.Efd.clear();
      r.Ifd.clear();
      records.push_back(std::move(r));
    }
    events = noise::whitened_events(model, std::move(records), {.measured_states = false});
    base = fit::fit(model.under_test(), events, fit::free_parameters(model.plant, kPriorSd), {});
    const hypothesis::Trial trial{events, kPriorSd, kAdequate};
    held_out = hypothesis::hold_out(trial, model.under_test(), {}, base);
    torque = reduced::free_input(fit::InputKind::torque, model.under_test(), events,
                                 fit::free_parameters(model.plant, kPriorSd), base, 2);
  }
  UserModelSearch search(int threads = 2) {
    return search_user_models({model, {events, kPriorSd, kAdequate}, base, held_out, torque, field, threads});
  }
};
sim::Effect torque_user_model(const std::string& value) {
  return sim::user_models::make_user_model(
      "name = \"TRUTH\"\ntitle = \"t\"\nsource = \"s\"\noutput = \"Tm\"\naction = \"add\"\nvalue = \"" +
          value + "\"\n",
      "truth.toml");
}

TEST(UserModelSearchTest, FindsTorqueLimitedAboveASpeed) {
  const sim::Effect user_model = torque_user_model("-0.02 * clamp(speed / 0.001, -1, 1)");
  Case c({1, 3}, &user_model, [](int, playin::PlaybackRun&) {});
  ASSERT_GT(c.base.reduced_chi2(), 5);
  ASSERT_LT(c.torque.reduced_chi2(), 1.2);
  const UserModelSearch s = c.search();
  std::string tried;
  for (const auto& f : s.findings)
    tried +=
        fmt::format("{} leaves {:.3f}: {}\n", f.words, f.judgement.fit.reduced_chi2(), f.judgement.why_not);
  ASSERT_NE(s.found(), nullptr) << tried;
  const UserModelFinding& f = *s.found();
  EXPECT_EQ(f.user_model.signal, "speed");
  EXPECT_THAT(f.user_model.family, testing::StartsWith("limited"));
  for (const auto& h : f.judgement.held_out) {
    EXPECT_GT(h.before, 5) << h.record;
    EXPECT_LT(h.after, thresholds::adequacy.reduced_chi2.value)
        << h.record;  // chi2 per value of 1802 values: 1 + 3.6 standard deviations
  }
  for (const auto& p : f.judgement.fit.parameters) {
    if (p.name == "L") {
      EXPECT_NEAR(p.value, -0.02, 4 * p.error);
    }
    if (p.name == "w") {
      EXPECT_NEAR(p.value, 0.001, 4 * p.error);
    }
  }
  EXPECT_THAT(user_model_sentence(s, 30),
              testing::HasSubstr("explains the records. A user-defined model does: a torque of -0.0"));
  // The file contains the user-defined model that was judged.
  const sim::Effect read = sim::user_models::make_user_model(f.toml, "found.toml");
  for (std::size_t i = 0; i < read.parameters.size(); ++i)
    EXPECT_DOUBLE_EQ(read.parameters[i].default_value, f.user_model.parameters[i].value)
        << read.parameters[i].name;
}

TEST(UserModelSearchFull, FindsPulseAtARecordTime) {
  const sim::Effect user_model =
      torque_user_model("0.02 * (clamp((t - 3) / 0.05, 0, 1) - clamp((t - 4.5) / 0.05, 0, 1))");
  const UserModelSearch s = Case({1, 2, 3}, &user_model, [](int, playin::PlaybackRun&) {}).search();
  ASSERT_NE(s.found(), nullptr);
  EXPECT_THAT(s.found()->user_model.family, testing::StartsWith("pulse"));
  for (const auto& h : s.found()->judgement.held_out)
    EXPECT_LT(h.after, thresholds::adequacy.reduced_chi2.value) << h.record;
}
TEST(UserModelSearchFull, FindsOscillation) {
  const sim::Effect user_model =
      torque_user_model("0.02 * clamp((t - 3) / 0.05, 0, 1) * sin(2 * pi * 0.7 * t)");
  const UserModelSearch s = Case({1, 2, 3}, &user_model, [](int, playin::PlaybackRun&) {}).search();
  ASSERT_NE(s.found(), nullptr);
  EXPECT_EQ(s.found()->user_model.family, "periodic");
  for (const auto& p : s.found()->judgement.fit.parameters)
    if (p.name == "f") {
      EXPECT_NEAR(p.value, 0.7, 4 * p.error);
    }
}
/// A random torque that differs between events follows no user-defined model.
TEST(UserModelSearchFull, RejectsRandomTorque) {
  Case c({1, 2, 3}, nullptr, [](int event, playin::PlaybackRun& run) {
    std::mt19937_64 generator(static_cast<unsigned>(100 + event));
    std::normal_distribution<double> normal;
    double value = 0;
    for (double t = 1.9; t < run.record->t.back(); t += 0.5) {
      run.torque.t.push_back(t);
      run.torque.value.push_back(value);
      value += 0.005 * normal(generator);
    }
  });
  ASSERT_GT(c.base.reduced_chi2(), 2);
  ASSERT_LT(c.torque.reduced_chi2(), thresholds::adequacy.reduced_chi2.value);
  const UserModelSearch s = c.search();
  EXPECT_GT(s.ranked.size(), 60u);
  EXPECT_EQ(s.found(), nullptr) << s.found()->words;
  EXPECT_EQ(user_model_sentence(s, 30), "");
}

}  // namespace
}  // namespace swingbank::validate::user_model_search
