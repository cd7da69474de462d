#pragma once
// Records of a .dyr as blocks of plants: which effect a model is, its parameters, its place.
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/formats/psse.hpp"
#include "sim/grid/lacking.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// Which loads a load model of a .dyr is for. Where several are for one load the first of these counts.
enum class Reach { load, owner, zone, area, all };

/// The effect of a record, nullptr if there is none, and the loads it is for; names that stand for another
/// count: IEELAR is IEELBL for an area.
std::pair<const Effect*, Reach> effect_of_dyr(const formats::DyrRecord& record);
/// Gives records at an extended bus name (name and base voltage, 'UNIT        20.000') the number of that
/// bus; a name that the network does not have, or has twice, stays.
void find_named_buses(std::vector<formats::DyrRecord>& records, const network::Network& network);
/// Why a record of an unknown model is refused, for messages.
std::string lacking_text(const std::string& dyr);
/// Names of the machines that have a .dyr form, for messages.
std::string machine_names();
/// Symbols of the columns: "6: TA/TB TB K".
std::string columns_text(const Effect& effect);

/// The name it goes by: of a user-written model its own.
inline std::string name_of(const formats::DyrRecord& r) { return r.user.empty() ? r.model : r.user; }
/// A user-written model that is one of ours, without IC, IT, NI, NC, NS, NV before its parameters; a model of
/// a switched shunt without the mechanically switched ones beside it; any other record as it is.
formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect);
/// As the id of a record that names no switched shunt: the first one of its bus.
inline constexpr std::string_view kAnyShunt = "*";
/// A bus or circuit that a parameter names (Elsewhere); 0: none.
int number_in(const plant::Block& block, int parameter);
/// Number of the bus whose voltage a model regulates; 0: its own, or none.
int regulated_bus(const plant::Block& block);
/// Its index, -1 where there is none; a bus that the network has not is a problem.
int regulated_index(const network::Network& network, const plant::Block& block, const std::string& where,
                    Problems& problems);
/// What was done to a record that is shorter or longer than its model takes it.
struct Completion {
  bool sound = false;  ///< it is now as long as that
  std::string what;    ///< empty: it was
  std::string place;   ///< record, and each value that was filled in or left out
};
/// Makes the record as long as its model takes it, if that is asked for; else it is a problem.
Completion complete(const Effect& effect, formats::DyrRecord& record, Lacking lacking,
                    const std::string& where, Problems& problems);
/// The record's values, standard ones where it has no column.
plant::Block values_of(const Effect& effect, const formats::DyrRecord& record);

/// What is wrong with a record of a known model; empty if nothing is. `g`: its generator, if there is one.
std::string fault_of(const Effect& effect, formats::DyrRecord record, const network::Generator* g,
                     const std::string& where);

/// What the .raw says of a unit: its generator, and the file's name for messages.
struct RawGenerator {
  const network::Generator& generator;
  const std::string& origin;
};
/// The step-up transformer that a .raw keeps in the generator's record (RT, XT); no effect if there is none.
plant::Block transformer_of(const network::Generator& g);
/// Puts ZR and ZX into the parameters that PSS/E keeps in the .raw.
void take_from_raw(plant::Block& block, const network::Generator& g);
/// Checks the block and puts it into its slot; a slot that is taken is a problem. A source reactance of the
/// .dyr that contradicts ZX is used; the warning of it is returned, empty if there is none.
std::string place(plant::Plant& plant, plant::Block block, const RawGenerator& raw, const std::string& where,
                  Problems& problems);
void sort_controls(plant::Plant& plant);
/// What a block's values ask for and its equations leave out, as a warning; empty if nothing.
std::string remark_on(const plant::Block& block, const std::string& where, const std::string& plant);
/// Whether a machine's derivatives change with Efd, tried out: a classical machine's do not.
bool reads_field_voltage(const Effect& machine);
/// Whether a control in this slot acts through the field voltage alone.
bool acts_on_field(Slot slot);
/// Controls of the field voltage at a machine whose equations do not read it, one sentence each.
std::vector<std::string> idle_controls(const plant::Plant& plant);
/// Controls that have no place beside the plant's source become problems.
void check_fit(const plant::Plant& plant, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
