#pragma once
// State and rules common to the readers of .raw and .epc files.
#include <array>
#include <complex>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sim/formats/detail/identities.hpp"
#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/consistency.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::formats {

using Impedance = std::complex<long double>;

/// Reader of one network file.
class NetworkReader {
 public:
  NetworkReader(const NetworkReader&) = delete;

 protected:
  /// `name` replaces the file name in messages.
  NetworkReader(std::vector<std::string> lines, std::string name, const RawOptions& options)
      : file_(std::move(name)), lines_(std::move(lines)), options_(options) {}

  /// As Identities::bus_index().
  int find_bus(int number, const psse::Fields& fields) {
    return identities_.bus_index(index_, number, section_, fields);
  }
  /// Checks a status; `name`: its field in messages. Returns true if the equipment is in service.
  bool status(int value, const char* name, const psse::Fields& fields);
  [[nodiscard]] double pu(long double mw) const { return static_cast<double>(mw / base_); }
  [[nodiscard]] network::Bus& at(int bus) { return network_.buses[static_cast<std::size_t>(bus)]; }

  /// Adds a bus. A number that is not positive is a problem, a voltage that is not positive becomes 1 pu.
  void add_bus(network::Bus b, const psse::Fields& fields);
  /// Refuses a branch from a bus to itself. `what`: "a branch".
  void check_ends(const char* what, const network::Branch& b, const psse::Fields& fields);
  /// Replaces a branch impedance up to network::kLeastImpedance by j kLeastImpedance, with a remark.
  void raise_impedance(network::Branch& b, const psse::Fields& fields);
  /// Returns a transformer of impedance z [pu on the system base].
  static network::Branch transformer_of(int from, int to, std::string circuit, bool in_service, Impedance z);
  /// Returns the impedances of the three windings from the impedances between windings 1-2, 2-3 and 3-1.
  static std::array<Impedance, 3> star_equivalent(Impedance z12, Impedance z23, Impedance z31);
  /// Adds the star point of a three-winding transformer and returns its index.
  int add_star_point(const std::array<int, 3>& ends, const std::string& circuit, bool in_service, double vm,
                     double va);

  /// Returns the id of a switched shunt among the shunts of its bus: "SW", "SW2", "SW+".
  [[nodiscard]] std::string switched_id(int bus, const std::string& id) const;
  /// Returns the index of the bus that a switched shunt regulates. It is the shunt's own bus if `number` is
  /// 0, or if bus `number` is missing (with a remark). `field`: "SWREG = ", for the remark.
  int regulated_by(int bus, int number, const char* field, const psse::Fields& fields);
  /// Adds the steps of one block [pu each]. Reactors and capacitors accumulate separately.
  void add_steps(network::SwitchedShunt& shunt, int count, double each, const psse::Fields& fields);

  /// Fields of a generator's machine base, the system base, and the step-up transformer, for messages.
  struct MachineNames {
    const char *mva, *base, *r, *x;
  };
  /// Checks machine base and step-up transformer. A base that is not positive becomes the system base, or is
  /// a problem if only units are read. `place`: generator in remarks.
  void check_machine(network::Generator& g, const MachineNames& names, const std::string& place,
                     const psse::Fields& fields);
  /// Makes the generator regulate its own bus to the voltage in the file, with a remark.
  void regulate_own_bus(network::Generator& g, const char* what, const std::string& where);

  /// Takes isolated equipment out of service and checks that all values are finite.
  void check_network();
  /// Completes a network that was read without problems: star points, duplicates, devices, generators,
  /// islands. `place`: place of generator i in the file.
  void complete_network(const std::function<std::string(std::size_t)>& place);
  RawSurvey take_survey() {
    return {std::move(network_), std::move(generator_line_), std::move(branch_line_), problems_.list()};
  }

  std::string file_;
  std::vector<std::string> lines_;
  RawOptions options_;
  long double base_ = 0.0L;  ///< system base [MVA]
  network::Network network_;
  Problems problems_;
  Identities identities_{options_, network_, problems_};
  std::string section_;       ///< section being read
  std::map<int, int> index_;  ///< index of each bus number
  std::vector<int> generator_line_, branch_line_;
  std::vector<network::Device> devices_;
  std::set<int> stars_;      ///< indices of the star points of three-winding transformers
  bool units_only_ = false;  ///< true: errors that concern only the network are not reported
};

}  // namespace swingbank::sim::formats
