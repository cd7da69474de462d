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

template <class T>
std::string steady_of(const void* data, const T* p, T* c, Signals<T>& s, T* x) {
  return steady(of(data), p, c, s, x);
}
/// Computes each element of the SIMD batch by itself.
template <int N>
std::string steady_of(const void* data, const Pack<N>* p, Pack<N>* c, Signals<Pack<N>>& s, Pack<N>* x) {
  const Definition& user_model = of(data);
  for (int lane = 0; lane < N; ++lane) {
    std::vector<double> one_p, one_c(static_cast<std::size_t>(user_model.code.coefficients)),
        one_x(user_model.states.size());
    for (std::size_t i = 0; i < user_model.parameters.size(); ++i) one_p.push_back(p[i][lane]);
    one_c[kFrequency] = c[kFrequency][lane];
    Signals<double> one_s;
    for (std::size_t i = 0; i < kSignals.size(); ++i)
      one_s.*kMembers<double>[i] = (s.*kMembers<Pack<N>>[i])[lane];
    if (auto why = steady(user_model, one_p.data(), one_c.data(), one_s, one_x.data()); !why.empty())
      return why;
    for (std::size_t i = 0; i < one_c.size(); ++i) c[i].set(lane, one_c[i]);
    for (std::size_t i = 0; i < one_x.size(); ++i) x[i].set(lane, one_x[i]);
    const auto out = static_cast<std::size_t>(user_model.output);
    (s.*kMembers<Pack<N>>[out]).set(lane, one_s.*kMembers<double>[out]);
  }
  return {};
}

template <class T>
Ops<T> ops() {
  Ops<T> o;
  o.prepare =
      +[](const T*, const Conventions& conventions, T* c) { c[kFrequency] = T(conventions.frequency); };
  o.control.evaluate = &evaluate<T>;
  o.control.steady = [](const void* data, const T* p, T* c, Signals<T>& s, T* x) {
    return steady_of(data, p, c, s, x);
  };
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
