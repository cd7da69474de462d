#include "validate/playin/given.hpp"

#include <cmath>
#include <utility>

namespace swingbank::validate::playin {
namespace {

using At = Given::At;

/// A signal of a record, its destination, and the offset that is subtracted from it.
struct Source {
  double At::*to;
  const std::vector<double>* values;
  double less;
};

/// Returns the signals of the record that the component does not compute itself.
std::vector<Source> sources(const record::Record& r, const OperatingPoint& start) {
  const auto& speed = r.speed.empty() ? r.f : r.speed;
  std::vector<Source> all;
  if (r.component == record::Component::machine)
    all = {{&At::Efd, &r.Efd, start.Efd}, {&At::Pm, &r.Pm, start.Pm}};
  if (r.component == record::Component::exciter)
    all = {{&At::P, &r.P, 0},
           {&At::Q, &r.Q, 0},
           {&At::speed, &speed, start.speed},
           {&At::Ifd, &r.Ifd, start.Ifd},
           {&At::Vs, &r.Vs, start.Vs},
           {&At::Vref, &r.Vref, start.Vref},
           {&At::Pm, &r.Pm, start.Pm}};
  if (r.component == record::Component::governor)
    all = {{&At::P, &r.P, 0},
           {&At::Q, &r.Q, 0},
           {&At::speed, &speed, start.speed},
           {&At::Pref, &r.Pref, start.Pref}};
  std::erase_if(all, [](const Source& s) { return s.values->empty(); });
  return all;
}

/// Returns two signals as real and imaginary part of a phasor.
record::Record packed(const record::Record& r, const Source& a, const Source* b) {
  record::Record both;
  both.name = r.name;
  both.t = r.t;
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const Complex x((*a.values)[k] - a.less, b ? (*b->values)[k] - b->less : 0.0);
    both.V.push_back(std::abs(x));
    both.theta.push_back(std::arg(x));
  }
  return both;
}

}  // namespace

Given::Given(const record::Record& played, const std::vector<Switching>& switchings,
             const OperatingPoint& start)
    : before_(steady_values(start)) {
  auto plain = switchings;
  for (Switching& s : plain) s.has_before = s.has_after = false;  // known for the voltage only
  const std::vector<Source> all = sources(played, start);
  for (std::size_t i = 0; i < all.size(); i += 2) {
    const Source* second = i + 1 < all.size() ? &all[i + 1] : nullptr;
    pairs_.push_back(
        {all[i].to, second ? second->to : nullptr, VoltageCurve(packed(played, all[i], second), plain)});
  }
}

Given::At Given::operator()(int segment, double t) const {
  At at = before_;
  for (const Pair& pair : pairs_) {
    const Complex x = pair.curve(segment, t);
    at.*pair.first = x.real();
    if (pair.second) at.*pair.second = x.imag();
  }
  return at;
}

void set_to_initial(record::Record& r, const OperatingPoint& start) {
  const std::pair<std::vector<double>*, double> all[] = {
      {&r.P, start.P},       {&r.Q, start.Q},     {&r.speed, start.speed}, {&r.f, start.speed},
      {&r.Efd, start.Efd},   {&r.Ifd, start.Ifd}, {&r.Vs, start.Vs},       {&r.Vref, start.Vref},
      {&r.Pref, start.Pref}, {&r.Pm, start.Pm},   {&r.gate, 0.0}};
  for (const auto& [channel, value] : all) channel->assign(r.t.size(), value);
}

std::optional<Given> given_of(const record::Record& record, const std::vector<Switching>& switchings,
                              const OperatingPoint& start) {
  if (record.component == record::Component::plant) return std::nullopt;
  return Given(record, switchings, start);
}

Given::At Given::steady_values(const OperatingPoint& start) {
  At at;
  at.P = start.P;
  at.Q = start.Q;
  return at;
}

}  // namespace swingbank::validate::playin
