#include "sim/user_models/user_model.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/input_file.hpp"
#include "sim/user_models/detail/definition.hpp"

namespace swingbank::sim::user_models {
namespace {

const Definition& of(const void* data) { return *static_cast<const Definition*>(data); }

template <class T>
void evaluate(const void* data, const T* c, const T* x, Signals<T>& s, T* dx) {
  const Definition& user_model = of(data);
  Registers<T> registers;
  T value(0.0);
  run<T, false>(user_model.code.loop, c, x, s, registers.data(), dx, value);
  T& out = s.*kMembers<T>[static_cast<std::size_t>(user_model.output)];
  out = user_model.replaces ? value : out + value;
}

/// Returns element `lane` of a SIMD batch.
template <int N>
double lane_of(const Pack<N>& v, int lane) {
  return v[lane];
}
template <int N, int D>
Dual<double, D> lane_of(const Dual<Pack<N>, D>& v, int lane) {
  Dual<double, D> one;
  one.a = v.a[lane];
  for (std::size_t k = 0; k < D; ++k) one.d[k] = v.d[k][lane];
  return one;
}
template <int N>
void set_lane(Pack<N>& v, int lane, double a) {
  v.set(lane, a);
}
template <int N, int D>
void set_lane(Dual<Pack<N>, D>& v, int lane, const Dual<double, D>& one) {
  v.a.set(lane, one.a);
  for (std::size_t k = 0; k < D; ++k) v.d[k].set(lane, one.d[k]);
}
template <class T>
constexpr int kLanesOf = 0;  ///< number of elements of a SIMD batch; 0: T is a single value
template <int N>
constexpr int kLanesOf<Pack<N>> = N;
template <int N, int D>
constexpr int kLanesOf<Dual<Pack<N>, D>> = N;

template <class T>
std::string steady_of(const void* data, const T* p, T* c, Signals<T>& s, T* x) {
  const Definition& user_model = of(data);
  if constexpr (kLanesOf<T> == 0) {
    return steady(user_model, p, c, s, x);
  } else {  // for each element of the SIMD batch
    using One = decltype(lane_of(*p, 0));
    for (int lane = 0; lane < kLanesOf<T>; ++lane) {
      std::vector<One> one_p, one_c(static_cast<std::size_t>(user_model.code.coefficients), One(0.0)),
          one_x(user_model.states.size(), One(0.0));
      for (std::size_t i = 0; i < user_model.parameters.size(); ++i) one_p.push_back(lane_of(p[i], lane));
      one_c[kFrequency] = lane_of(c[kFrequency], lane);
      Signals<One> one_s;
      for (std::size_t i = 0; i < kSignals.size(); ++i)
        one_s.*kMembers<One>[i] = lane_of(s.*kMembers<T>[i], lane);
      if (auto why = steady(user_model, one_p.data(), one_c.data(), one_s, one_x.data()); !why.empty())
        return why;
      for (std::size_t i = 0; i < one_c.size(); ++i) set_lane(c[i], lane, one_c[i]);
      for (std::size_t i = 0; i < one_x.size(); ++i) set_lane(x[i], lane, one_x[i]);
      const auto out = static_cast<std::size_t>(user_model.output);
      set_lane(s.*kMembers<T>[out], lane, one_s.*kMembers<One>[out]);
    }
    return {};
  }
}

template <class T>
Ops<T> ops() {
  Ops<T> o;
  o.prepare =
      +[](const T*, const Conventions& conventions, T* c) { c[kFrequency] = T(conventions.frequency); };
  o.control.evaluate = &evaluate<T>;
  o.control.steady = &steady_of<T>;
  return o;
}
template <class... T>
std::tuple<Ops<T>...> all_ops(std::tuple<T...>*) {
  return {ops<T>()...};
}

std::vector<double> coefficients(const Definition& user_model, const double* p) {
  std::vector<double> c(static_cast<std::size_t>(user_model.code.coefficients), 0.0);
  c[kFrequency] = 60.0;  // any value: the checks must not depend on the frequency
  fill<double>(user_model, p, nullptr, c.data());
  return c;
}

void check(const void* data, const double* p, const std::string& where, Problems& problems) {
  const Definition& user_model = of(data);
  bool numbers = true;
  for (std::size_t i = 0; i < user_model.parameters.size(); ++i) {
    if (std::isfinite(p[i])) continue;
    numbers = false;
    problems.add(fmt::format("{} = {}", user_model.parameters[i].name, p[i]), where,
                 "a parameter is a finite number", "give one");
  }
  if (!numbers) return;
  const auto c = coefficients(user_model, p);
  const auto value = [&](int i) { return c[static_cast<std::size_t>(i)]; };
  for (const Requirement& r : user_model.requirements) {
    const double a = value(r.left), b = value(r.right);
    if (!(r.op == Op::less ? a < b : a <= b))
      problems.add(fmt::format("{} is violated: {:g} and {:g}", r.text, a, b), where,
                   "user-defined model " + user_model.name + " requires it at " + r.where,
                   "change the parameters");
  }
  for (const auto& [index, text] : user_model.finite)
    if (!std::isfinite(value(index)))
      problems.add(fmt::format("{} = {} with these parameters", text, value(index)), where,
                   "user-defined model " + user_model.name + " needs a finite number",
                   "change the parameters");
}

std::vector<double> switching_times(const void* data, const double* p) {
  const Definition& user_model = of(data);
  const auto c = coefficients(user_model, p);
  std::vector<double> all;
  for (const int i : user_model.switching_times) all.push_back(c[static_cast<std::size_t>(i)]);
  return all;
}

}  // namespace

Effect make_effect(Definition definition) {
  const auto shared = std::make_shared<const Definition>(std::move(definition));
  const Definition& user_model = *shared;
  Effect e{};
  e.name = user_model.name;
  e.title = user_model.title;
  e.source = user_model.source;
  e.description = user_model.description;
  e.slot = user_model.slot;
  e.parameters = user_model.parameters;
  e.states = user_model.states;
  e.raw_resistance = e.raw_reactance = -1;
  e.coefficients = user_model.code.coefficients;
  e.check = &check;
  e.unphysical = +[](const double*) { return std::string_view(); };
  if (!user_model.switching_times.empty()) e.switching_times = &switching_times;
  e.ops = all_ops(static_cast<Scalars*>(nullptr));
  e.user_model = shared;
  return e;
}

Effect make_user_model(const std::string& text, const std::filesystem::path& name) {
  return user_models::make_effect(read_definition(text, name));
}

bool same_effect(const Effect& a, const Effect& b) {
  return &a == &b ||
         (a.user_model && b.user_model && of(a.user_model.get()).text == of(b.user_model.get()).text);
}

const Effect& load_user_model(const std::string& text, const std::filesystem::path& name,
                              library::EffectLibrary& library) {
  Effect effect = make_user_model(text, name);
  const Effect* there = library.find(effect.name);
  if (there == nullptr) return library.add(std::move(effect));
  if (same_effect(*there, effect)) return *there;
  throw InputError({"a second effect " + std::string(effect.name), name.string(),
                    "a compiled effect or another user-defined model has the name", "choose another name"});
}

const Effect& load_user_model(const std::filesystem::path& file, library::EffectLibrary& library) {
  return load_user_model(read_input(file, "cannot read the user-defined model", "give the path of its .toml"),
                         file, library);
}

}  // namespace swingbank::sim::user_models
