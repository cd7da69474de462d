#pragma once
// The positive-sequence network as read from a file: everything in per unit on base_mva, angles in rad.
#include <array>
#include <string>
#include <vector>

#include "base/complex.hpp"

namespace swingbank::sim::network {

enum class BusType { load = 1, generator = 2, slack = 3, isolated = 4 };

struct Bus {
  int number;  ///< as in the file; elsewhere buses are indices into Network::buses
  std::string name;
  double kv;  ///< nominal voltage [kV]
  BusType type;
  double vm, va;  ///< voltage in the file: start of the power flow [pu, rad]
  int area = 1, zone = 1, owner = 1;
  /// Numbers of the buses of a three-winding transformer whose star point this is; zeros: a bus of the file.
  std::array<int, 3> star_of{};
  [[nodiscard]] bool is_star() const { return star_of[0] != 0; }
};
/// What a load of the network stands for.
enum class LoadKind {
  load,
  generator,  ///< a generator without a machine model, as negative consumption
  device,     ///< equipment that has no model here (dc line, FACTS device), as what it draws in the file
  shunt       ///< a switched shunt with a model of its own, as its admittance in the file
};
/// Consumption P + jQ [pu]: constant power, constant current and constant admittance parts, each at 1 pu
/// voltage: S = power + current V + admittance V^2.
struct Load {
  int bus;
  std::string id;
  Complex power, current, admittance;
  int area = 1, zone = 1, owner = 1;  ///< load models of a .dyr may name these instead of a bus
  LoadKind kind = LoadKind::load;
};
struct Shunt {
  int bus;
  std::string id;
  Complex admittance;
};
/// A shunt that is switched in steps to hold a voltage within a band.
struct SwitchedShunt {
  int bus;
  std::string id;             ///< of the shunt in Network::shunts
  double present;             ///< its susceptance [pu]
  int regulated;              ///< index of the bus whose voltage it holds
  double least, most;         ///< the band of that voltage [pu]
  std::vector<double> steps;  ///< susceptances it can take, ascending [pu]
};
/// Line or two-winding transformer: pi section with an ideal tap (ratio, phase shift) on the `from` side.
struct Branch {
  int from, to;
  std::string circuit;
  double r, x, b;                    ///< series impedance, total charging [pu]
  double tap = 1.0, shift = 0.0;     ///< [-, rad]
  Complex shunt_from{}, shunt_to{};  ///< line shunts, magnetising admittance [pu]
  bool in_service = true;
  bool transformer = false;  ///< which section of a .raw it belongs to; the equations are the same
};
struct Generator {
  int bus;
  std::string id;
  double p, q;    ///< dispatch [pu on base_mva]
  double vset;    ///< voltage it holds, at `regulated` if that is a bus [pu]
  double mva;     ///< machine base
  double zr, zx;  ///< ZSORCE [pu on mva]
  bool in_service = true;
  double q_min = -99.99, q_max = 99.99;  ///< reactive limits [pu on base_mva]
  double rt = 0.0, xt = 0.0;             ///< step-up transformer between machine and bus [pu on mva]; 0: none
  int regulated = -1;                    ///< index of the bus whose voltage it holds; -1: its own
  double share = 100.0;                  ///< of the reactive power of all that hold this bus [%]
};
/// Something done to a case beyond reading it: what, and every place it was done at.
struct Remark {
  std::string what;
  std::vector<std::string> places;
  friend bool operator==(const Remark&, const Remark&) = default;
};

struct Network {
  std::string title, origin;  ///< origin: the file it was read from
  double base_mva = 100.0, frequency = 60.0;
  std::vector<Bus> buses;
  std::vector<Load> loads;
  std::vector<Shunt> shunts;
  std::vector<SwitchedShunt> switched;
  std::vector<Branch> branches;
  std::vector<Generator> generators;
  std::vector<Remark> remarks;  ///< what was done to the case

  /// Notes that `what` was done at `place`.
  void remark(const std::string& what, const std::string& place);
  /// Index of the bus with this number, or -1; star points have none.
  [[nodiscard]] int bus_index(int number) const;
  /// Index of the branch between two bus numbers (either direction) with this circuit id, or -1.
  [[nodiscard]] int branch_index(int from, int to, const std::string& circuit) const;
  /// "bus 7", "star point of 2-3-4": for messages.
  [[nodiscard]] std::string bus_text(int bus) const;
  /// "1-4 circuit 1", "winding at bus 2 of 2-3-4 circuit 1": for messages.
  [[nodiscard]] std::string branch_text(const Branch& branch) const;
};

}  // namespace swingbank::sim::network
