#pragma once
// Records of a .dyr as blocks of plants: which effect a model is, its parameters, its place.
#include <string>
#include <utility>

#include "sim/formats/psse.hpp"
#include "sim/plant/plant.hpp"

namespace swingbank::sim::grid {

/// Which loads a load model of a .dyr is for. Where several are for one load the first of these counts.
enum class Reach { load, owner, zone, area, all };

/// The effect of a record, nullptr if there is none, and the loads it is for; names that stand for another
/// count: IEELAR is IEELBL for an area.
std::pair<const Effect*, Reach> effect_of_dyr(const formats::DyrRecord& record);
/// Names of all effects that have a .dyr form, and of the machines among them, for messages.
std::string dyr_names();
std::string machine_names();
/// Symbols of the columns: "6: TA/TB TB K".
std::string columns_text(const Effect& effect);

/// The name it goes by: of a user-written model its own.
inline std::string name_of(const formats::DyrRecord& r) { return r.user.empty() ? r.model : r.user; }
/// A user-written model that is one of ours, without IC, IT, NI, NC, NS, NV before its parameters; any other
/// record as it is.
formats::DyrRecord plain(formats::DyrRecord record, const Effect& effect);
/// Whether the record has as many parameters as the effect; a problem if not, whose remedy `or_else` goes on.
bool complete(const Effect& effect, const formats::DyrRecord& record, const std::string& where,
              Problems& problems, const std::string& or_else = "");
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
/// Controls that have no place beside the plant's source become problems.
void check_fit(const plant::Plant& plant, const std::string& where, Problems& problems);

}  // namespace swingbank::sim::grid
