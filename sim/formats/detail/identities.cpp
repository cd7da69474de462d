#include "sim/formats/detail/identities.hpp"

#include <algorithm>

namespace swingbank::sim::formats {

int Identities::bus_index(const std::map<int, int>& buses, int number, const std::string& section,
                          const psse::Fields& fields) {
  const auto found = buses.find(number);
  if (found != buses.end()) return found->second;
  const std::string bus = "bus " + std::to_string(number);
  if (options_.drop_refused)
    network_.remark("equipment at buses that are not in the bus section is ignored (--drop-refused)",
                    section + " record at " + bus + " (" + fields.where() + ")");
  else
    problems_.add(bus + " is not in the bus section", fields.where(), "the record refers to it",
                  "add the bus, correct the number, or leave the equipment out with --drop-refused");
  return -1;
}

bool Identities::once(const std::string& identity, const psse::Fields& fields) {
  const auto [found, fresh] = seen_.emplace(identity, fields.line());
  if (fresh) return true;
  const std::string first = "already on line " + std::to_string(found->second);
  if (options_.drop_refused)
    network_.remark("equipment that appears a second time is ignored (--drop-refused)",
                    identity + " (" + fields.where() + ", " + first + ")");
  else
    problems_.add(identity + " appears twice", fields.where(), "it is " + first,
                  identity.starts_with("bus ")
                      ? "remove one, or leave the later one out with --drop-refused"
                      : "remove one or give it another id; --repeated voltages keeps it under a new id if "
                        "this agrees with the file's voltages, and --drop-refused leaves it out");
  return !options_.drop_refused;
}

std::optional<std::string> Identities::id(network::Duplicate of, const std::string& before,
                                          const std::string& given, const std::string& after,
                                          const psse::Fields& fields) {
  const auto identity = [&](const std::string& id) { return before + " '" + id + "'" + after; };
  if (options_.repeated == Repeated::refused || !seen_.contains(identity(given))) {
    if (once(identity(given), fields)) return given;
    return {};
  }
  constexpr std::string_view letters = "RSTUVWXYZ";  // first of two characters of a new id
  for (const char letter : letters)
    for (int i = 1; i <= 9; ++i) {
      of.id = letter + std::to_string(i);
      if (seen_.contains(identity(of.id))) continue;
      of.text = identity(given) + " (" + fields.where() + ", already on line " +
                std::to_string(seen_.at(identity(given))) + ")";
      seen_.emplace(identity(of.id), fields.line());
      const auto same = [&](const network::Duplicate& d) {  // another section of the same line
        return d.kind == of.kind && d.buses == of.buses && d.id == of.id;
      };
      if (std::ranges::none_of(kept_, same)) kept_.push_back(of);
      return of.id;
    }
  problems_.add("too many duplicates of " + identity(given), fields.where(), "all 81 new ids are in use",
                "give it another id");
  return {};
}

}  // namespace swingbank::sim::formats
