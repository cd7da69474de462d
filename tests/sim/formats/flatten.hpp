#pragma once
// A network as a list of bits, to compare the contents of two files.
#include <gtest/gtest.h>

#include <bit>
#include <string>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// Every number of a network as bits, in a fixed order; names and flags as text.
struct Flat {
  std::vector<std::uint64_t> numbers;
  std::string words;
  void add(double v) { numbers.push_back(std::bit_cast<std::uint64_t>(v)); }
  void add(Complex v) {
    add(v.real());
    add(v.imag());
  }
  template <class... T>
  void all(const T&... v) {
    (add(v), ...);
  }
};
inline Flat flatten(const network::Network& n) {
  Flat f;
  f.words = n.title;
  f.all(n.base_mva, n.frequency);
  for (const network::Bus& b : n.buses) {
    f.words += "|" + std::to_string(b.number) + b.name + std::to_string(static_cast<int>(b.type)) + ":" +
               std::to_string(b.area) + ":" + std::to_string(b.zone) + ":" + std::to_string(b.owner);
    f.all(b.kv, b.vm, b.va);
  }
  for (const network::Load& l : n.loads) {
    f.words += "|" + std::to_string(l.bus) + l.id + ":" + std::to_string(l.area) + ":" +
               std::to_string(l.zone) + ":" + std::to_string(l.owner);
    f.all(l.power, l.current, l.admittance);
  }
  for (const network::Shunt& s : n.shunts) {
    f.words += "|" + std::to_string(s.bus) + s.id;
    f.add(s.admittance);
  }
  for (const network::Branch& b : n.branches) {
    f.words += "|" + std::to_string(b.from) + "-" + std::to_string(b.to) + b.circuit +
               (b.in_service ? "on" : "off") + (b.transformer ? "T" : "L");
    f.all(b.r, b.x, b.b, b.tap, b.shift, b.shunt_from, b.shunt_to);
  }
  for (const network::Generator& g : n.generators) {
    f.words += "|" + std::to_string(g.bus) + g.id + (g.in_service ? "on" : "off") + ">" +
               std::to_string(g.regulated);
    f.all(g.p, g.q, g.vset, g.mva, g.zr, g.zx, g.q_min, g.q_max, g.rt, g.xt, g.share);
  }
  return f;
}
/// Expects every number except `origin` to be equal to the last bit.
inline void expect_same(const network::Network& one, const network::Network& other) {
  const Flat a = flatten(one), b = flatten(other);
  EXPECT_EQ(a.words, b.words);
  ASSERT_EQ(a.numbers.size(), b.numbers.size());
  for (std::size_t i = 0; i < a.numbers.size(); ++i)
    ASSERT_EQ(a.numbers[i], b.numbers[i]) << "number " << i << ": " << std::bit_cast<double>(a.numbers[i]);
}

}  // namespace swingbank::sim::formats
