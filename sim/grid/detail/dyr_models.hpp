#pragma once
// Conversion of .dyr records to blocks of plants: effect, parameter values and slot of a record.
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// Scope of a load model of a .dyr. If several models apply to a load, the first in this order takes
/// precedence.
enum class Reach { load, owner, zone, area, all };

/// Returns the effect of a record, or nullptr, and for a load model its scope. Aliases are resolved: IEELAR
/// is IEELBL for an area.
std::pair<const Effect*, Reach> effect_of_dyr(const formats::DyrRecord& record);
/// Resolves extended bus names of records (name and base voltage, 'UNIT        20.000') to bus numbers. A
/// name that is missing or ambiguous in the network stays in the record.
void find_named_buses(std::vector<formats::DyrRecord>& records, const network::Network& network);
/// Returns the reason for messages that refuse an unknown model. `dyr`: name of the file.
std::string lacking_text(const std::string& dyr);
/// Returns the names of the machines that have a .dyr form, for messages.
std::string machine_names();
/// Returns the number and the symbols of an effect's columns: "6: TA/TB TB K".
std::string columns_text(const Effect& effect);

/// Returns the model's name; for a user-written model, its own name.
inline std::string name_of(const formats::DyrRecord& r) { return r.user.empty() ? r.model : r.user; }
/// Reduces a record to the parameters of its effect. Drops the codes IC, IT, NI, NC, NS, NV of a user-written
/// model, and the mechanically switched shunts in the model of a switched shunt. Orders the values of an
/// alias as the effect's columns, and turns remaining texts into faults. Other records are returned
/// unchanged.
formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect);
/// Id of a record that names no switched shunt; it applies to the first one at its bus.
inline constexpr std::string_view kAnyShunt = "*";
/// Returns the number of the bus or circuit that a parameter names (Elsewhere); 0: none.
int number_in(const plant::Block& block, int parameter);
/// Returns the number of the bus whose voltage a model regulates; 0: its own bus, or none.
int regulated_bus(const plant::Block& block);
/// Returns the index of the regulated bus, or -1. A bus that the network does not have is a problem.
int regulated_index(const network::Network& network, const plant::Block& block, const std::string& where,
                    Problems& problems);
/// Result of completing a record that is shorter or longer than its model requires.
struct Completion {
  bool sound = false;  ///< true if the record now has the required length
  std::string what;    ///< description of the change; empty if there was none
  std::string place;   ///< record, and each value that was filled in or dropped
};
/// Adjusts the record to the length that its model requires, as `lacking` allows; otherwise adds a problem.
Completion complete(const Effect& effect, formats::DyrRecord& record, Lacking lacking,
                    const std::string& where, Problems& problems);
/// Returns the record's values, with defaults for parameters without a column.
plant::Block values_of(const Effect& effect, const formats::DyrRecord& record);

/// Returns the error of a record of a known model, or "". `g`: its generator, or nullptr.
std::string fault_of(const Effect& effect, formats::DyrRecord record, const network::Generator* g,
                     const std::string& where);

/// Generator of a unit in the .raw, and the file's name for messages.
struct RawGenerator {
  const network::Generator& generator;
  const std::string& origin;
};
/// Returns the step-up transformer that the .raw keeps in the generator's record (RT, XT); its effect is null
/// if there is none.
plant::Block transformer_of(const network::Generator& g);
/// Sets the parameters that PSS/E keeps in the .raw from ZR and ZX.
void take_from_raw(plant::Block& block, const network::Generator& g);
/// Checks the block and inserts it into its slot; an occupied slot is a problem. If the source reactance of
/// the .dyr differs from ZX of the .raw, the .dyr takes precedence and a warning is returned; else "".
std::string place(plant::Plant& plant, plant::Block block, const RawGenerator& raw, const std::string& where,
                  Problems& problems);
/// Returns a warning about features that the block's values request and the model lacks, or "".
std::string remark_on(const plant::Block& block, const std::string& where, const std::string& plant);
/// Evaluates the machine's derivatives and returns true if they depend on Efd. The result is false for a
/// classical machine.
bool reads_field_voltage(const Effect& machine);
/// Returns true if a control in this slot acts only through the field voltage.
bool acts_on_field(Slot slot);
/// Returns one sentence per control that acts on the field voltage, if the machine does not depend on it.
std::vector<std::string> idle_controls(const plant::Plant& plant);
/// Adds a problem for every control that is incompatible with the plant's machine or converter.
void check_fit(const plant::Plant& plant, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
