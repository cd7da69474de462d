#pragma once
// Identity checks for the equipment of a network file: each identity is unique and each bus exists.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/formats/psse_text.hpp"
#include "sim/network/consistency.hpp"

namespace swingbank::sim::formats {

/// Registry of the identities of a file's equipment.
class Identities {
 public:
  /// All three arguments must outlive the object.
  Identities(const RawOptions& options, network::Network& network, Problems& problems)
      : options_(options), network_(network), problems_(problems) {}

  /// Returns the index of the bus with this number, or -1 if there is none. A missing bus is a problem; with
  /// RawOptions::drop_refused it is a remark, and the equipment must be dropped. `section`: section of the
  /// referring record.
  int bus_index(const std::map<int, int>& buses, int number, const std::string& section,
                const psse::Fields& fields);
  /// Registers an identity ("bus 5"). A duplicate is a problem; with RawOptions::drop_refused it is a remark.
  /// Returns false for a duplicate with drop_refused; the caller must then drop the equipment.
  bool once(const std::string& identity, const psse::Fields& fields);
  /// Returns the id of the equipment: `given` if the identity "`before` 'id'`after`" is unique or its
  /// duplicate is a problem, a new id if the duplicate is kept, none if it must be dropped. `of`: kind and
  /// bus numbers of the equipment.
  std::optional<std::string> id(network::Duplicate of, const std::string& before, const std::string& given,
                                const std::string& after, const psse::Fields& fields);
  /// Returns the duplicates that were kept under a new id.
  [[nodiscard]] const std::vector<network::Duplicate>& kept() const { return kept_; }

 private:
  const RawOptions& options_;
  network::Network& network_;
  Problems& problems_;
  std::map<std::string, int> seen_;  ///< identity -> line
  std::vector<network::Duplicate> kept_;
};

}  // namespace swingbank::sim::formats
