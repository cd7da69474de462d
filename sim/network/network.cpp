#include "sim/network/network.hpp"

#include <algorithm>

#include "sim/network/connectivity.hpp"

namespace swingbank::sim::network {

void Network::remark(const std::string& what, const std::string& place) {
  const auto same = std::ranges::find(remarks, what, &Remark::what);
  if (same == remarks.end())
    remarks.push_back({what, {place}});
  else
    same->places.push_back(place);
}

int Network::bus_index(int number) const {
  for (std::size_t i = 0; i < buses.size(); ++i)
    if (buses[i].number == number && !buses[i].is_star()) return static_cast<int>(i);
  return -1;
}

namespace {
std::string star_text(const Bus& star) {
  const auto& [first, second, third] = star.star_of;
  return std::to_string(first) + "-" + std::to_string(second) + "-" + std::to_string(third);
}
}  // namespace

std::string Network::bus_text(int bus) const {
  const Bus& b = buses[static_cast<std::size_t>(bus)];
  return b.is_star() ? "star point of " + star_text(b) : "bus " + std::to_string(b.number);
}

std::string Network::branch_text(const Branch& branch) const {
  const Bus &from = buses[static_cast<std::size_t>(branch.from)],
            &to = buses[static_cast<std::size_t>(branch.to)];
  const std::string ends = to.is_star()
                               ? "winding at bus " + std::to_string(from.number) + " of " + star_text(to)
                               : std::to_string(from.number) + "-" + std::to_string(to.number);
  return ends + " circuit " + branch.circuit;
}

std::vector<int> islands(const Network& network, const std::vector<int>& open) {
  std::vector<std::vector<int>> neighbours(network.buses.size());
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const Branch& b = network.branches[i];
    if (!b.in_service || std::binary_search(open.begin(), open.end(), static_cast<int>(i))) continue;
    neighbours[static_cast<std::size_t>(b.from)].push_back(b.to);
    neighbours[static_cast<std::size_t>(b.to)].push_back(b.from);
  }
  std::vector<int> island(network.buses.size(), -1);
  int count = 0;
  for (std::size_t start = 0; start < island.size(); ++start) {
    if (island[start] >= 0 || network.buses[start].type == BusType::isolated) continue;
    std::vector<int> stack{static_cast<int>(start)};
    island[start] = count;
    while (!stack.empty()) {
      const int bus = stack.back();
      stack.pop_back();
      for (const int next : neighbours[static_cast<std::size_t>(bus)]) {
        int& mark = island[static_cast<std::size_t>(next)];
        if (mark >= 0) continue;
        mark = count;
        stack.push_back(next);
      }
    }
    ++count;
  }
  return island;
}

std::string bus_list(const Network& network, const std::vector<int>& buses) {
  constexpr std::size_t most = 20;  // largest number of buses in a readable sentence
  std::string numbers, stars;
  std::size_t count = 0;
  for (std::size_t i = 0; i < buses.size() && i < most; ++i) {
    const Bus& bus = network.buses[static_cast<std::size_t>(buses[i])];
    std::string& text = bus.is_star() ? stars : numbers;
    if (!bus.is_star()) ++count;
    text += (text.empty() ? "" : ", ") +
            (bus.is_star() ? network.bus_text(buses[i]) : std::to_string(bus.number));
  }
  std::string text = numbers.empty() ? "" : (count == 1 ? "bus " : "buses ") + numbers;
  if (!stars.empty()) text += (text.empty() ? "" : ", ") + stars;
  if (buses.size() > most) text += " and " + std::to_string(buses.size() - most) + " more";
  return text;
}

}  // namespace swingbank::sim::network
