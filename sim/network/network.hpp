#pragma once
// The positive-sequence network as read from a file: everything in per unit on base_mva, angles in rad.
#include <array>
#include <string>
#include <vector>

#include "base/complex.hpp"

namespace swingbank::sim::network {

/// Type of a bus in the power flow: PQ, PV, slack or out of service. The values are those of PSS/E's IDE.
enum class BusType { load = 1, generator = 2, slack = 3, isolated = 4 };

/// Bus of a network.
struct Bus {
  int number;                         ///< number in the file; elsewhere a bus is an index into Network::buses
  std::string name;                   ///< name in the file
  double kv;                          ///< nominal voltage [kV]
  BusType type;                       ///< type in the power flow
  double vm, va;                      ///< voltage in the file, start value of the power flow [pu, rad]
  int area = 1, zone = 1, owner = 1;  ///< numbers in the file
  /// Bus numbers of the three-winding transformer with this star point; zeros: a bus of the file.
  std::array<int, 3> star_of{};
  /// Whether the bus is the star point of a three-winding transformer.
  [[nodiscard]] bool is_star() const { return star_of[0] != 0; }
};
/// Origin of a load.
enum class LoadKind {
  load,
  generator,  ///< a generator without a machine model, as negative consumption
  device,     ///< equipment without a model here (dc line, FACTS device) or an imbalance, from the file's
              ///< voltages
  shunt       ///< a switched shunt with a dynamic model, by its admittance in the power flow
};
/// Consumption P + jQ [pu] with constant-power, constant-current and constant-admittance parts at 1 pu
/// voltage: S = power + current V + admittance V^2.
struct Load {
  int bus;                             ///< bus index
  std::string id;                      ///< id in the file
  Complex power, current, admittance;  ///< [pu on base_mva] at 1 pu voltage
  int area = 1, zone = 1, owner = 1;   ///< load models of a .dyr may refer to these instead of a bus
  LoadKind kind = LoadKind::load;      ///< origin of the load
};
/// Shunt at a bus: fixed, or the present step of a switched shunt.
struct Shunt {
  int bus;             ///< bus index
  std::string id;      ///< id in the file
  Complex admittance;  ///< admittance [pu on base_mva]
};
/// A shunt that is switched in steps to keep a voltage within a band.
struct SwitchedShunt {
  int bus;                    ///< bus index
  std::string id;             ///< id of the shunt in Network::shunts
  double present;             ///< present susceptance [pu]
  int regulated;              ///< index of the regulated bus
  double least, most;         ///< voltage band [pu]
  std::vector<double> steps;  ///< available susceptances, ascending [pu]
};
/// Line or two-winding transformer: pi section with an ideal tap (ratio, phase shift) on the `from` side.
struct Branch {
  int from, to;                      ///< bus indices
  std::string circuit;               ///< circuit id in the file
  double r, x, b;                    ///< series impedance, total charging [pu]
  double tap = 1.0, shift = 0.0;     ///< ratio [-], phase shift [rad]
  Complex shunt_from{}, shunt_to{};  ///< line shunts, magnetising admittance [pu]
  bool in_service = true;            ///< status in the file
  bool transformer = false;          ///< listed as a transformer; the equations are the same
};
/// Generator or converter at a bus, as the power flow represents it.
struct Generator {
  int bus;                               ///< bus index
  std::string id;                        ///< id in the file
  double p, q;                           ///< dispatch [pu on base_mva]
  double vset;                           ///< voltage set-point, of bus `regulated` if given [pu]
  double mva;                            ///< machine base [MVA]
  double zr, zx;                         ///< ZSORCE [pu on mva]
  bool in_service = true;                ///< status in the file
  double q_min = -99.99, q_max = 99.99;  ///< reactive limits [pu on base_mva]
  double rt = 0.0, xt = 0.0;             ///< step-up transformer between machine and bus [pu on mva]; 0: none
  int regulated = -1;                    ///< index of the regulated bus; -1: its own
  double share = 100.0;  ///< share of the reactive power of all generators that regulate one bus [%]
};
/// A change to a case that goes beyond reading it, with every place of the change.
struct Remark {
  std::string what;                 ///< change, as text
  std::vector<std::string> places;  ///< places of the change
  /// Compares all members.
  friend bool operator==(const Remark&, const Remark&) = default;
};

/// Case of the power flow: buses and equipment, in per unit on base_mva.
struct Network {
  std::string title, origin;                  ///< origin: the file it was read from
  double base_mva = 100.0, frequency = 60.0;  ///< system base [MVA]; system frequency [Hz]
  std::vector<Bus> buses;                     ///< buses, star points included
  std::vector<Load> loads;                    ///< loads, dynamic ones included
  std::vector<Shunt> shunts;                  ///< fixed shunts, with the present step of each switched shunt
  std::vector<SwitchedShunt> switched;        ///< data of the switched shunts
  std::vector<Branch> branches;               ///< lines and transformers
  std::vector<Generator> generators;          ///< generators and converters
  std::vector<Remark> remarks;                ///< changes to the case

  /// Records that `what` was done at `place`.
  void remark(const std::string& what, const std::string& place);
  /// Returns the index of the bus with this number, or -1. Star points are not found.
  [[nodiscard]] int bus_index(int number) const;
  /// Returns "bus 7" or "star point of 2-3-4" for messages.
  [[nodiscard]] std::string bus_text(int bus) const;
  /// Returns "1-4 circuit 1" or "winding at bus 2 of 2-3-4 circuit 1" for messages.
  [[nodiscard]] std::string branch_text(const Branch& branch) const;
};

}  // namespace swingbank::sim::network
