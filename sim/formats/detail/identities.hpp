#pragma once
// Which equipment of a network file is read: every identity once, and only at buses that the file has.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/consistency.hpp"

namespace swingbank::sim::formats {

class Identities {
 public:
  /// All three outlive the object.
  Identities(const RawOptions& options, network::Network& network, Problems& problems)
      : options_(options), network_(network), problems_(problems) {}

  /// Index of the bus with this number. -1 if there is none: a problem, or a remark where the equipment is to
  /// be left out. `section`: of the record that refers to it.
  int bus_index(const std::map<int, int>& buses, int number, const std::string& section,
                const psse::Fields& fields);
  /// False where this identity ("bus 5") has been given before and the equipment is to be left out, which is
  /// noted. A problem where it is not to be; reading goes on.
  bool once(const std::string& identity, const psse::Fields& fields);
  /// The equipment's id: the given one where "`before` 'id'`after`" is the first of its name, a new one where
  /// repeated equipment is kept; nothing where it is not to be read. `of`: its kind and bus numbers.
  std::optional<std::string> id(network::Duplicate of, const std::string& before, const std::string& given,
                                const std::string& after, const psse::Fields& fields);
  /// The equipment that got a new id.
  [[nodiscard]] const std::vector<network::Duplicate>& kept() const { return kept_; }

 private:
  const RawOptions& options_;
  network::Network& network_;
  Problems& problems_;
  std::map<std::string, int> seen_;  ///< identity -> line
  std::vector<network::Duplicate> kept_;
};

}  // namespace swingbank::sim::formats
