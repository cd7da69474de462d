#pragma once
// PSLF .dyd files: the models that have a counterpart in a .dyr, read as its records and written from them.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"

namespace swingbank::sim::formats {

/// What a machine's record of a .dyd holds beside its .dyr columns; PSS/E keeps it in the .raw.
struct DydMachine {
  double mva = 0;         ///< base of the machine and, without a rating of their own, of its controls [MVA]
  double resistance = 0;  ///< armature resistance [pu]
  std::optional<double> reactance = {};  ///< of a classical machine [pu]
};

struct DydSurvey {
  /// In the form of a .dyr; a model without counterpart has its values as they stand, and a fault.
  DyrSurvey dyr;
  std::map<int, DydMachine> machines;      ///< by DyrRecord::line
  std::map<int, std::string> notes;        ///< by DyrRecord::line: what was converted
  std::map<int, std::string> names;        ///< by DyrRecord::line: the model's name in the .dyd, in capitals
  std::map<std::string, int> passed_over;  ///< names of the models that are passed over, and how often
};

/// Reads a .dyd: "model bus "name" kV "id" : #level mva=... values", values in the documented order or each
/// behind its name in quotes; '#' begins a comment, a '/' at the end of a line goes on with the next. Buses
/// are known by their numbers. A governor on a rating of its own (mwcap) is put onto the machine's base.
/// What PSLF has and the counterpart has not must be switched off, else the record has a fault that names
/// it. Meters and loads are passed over. Throws InputError only where the file cannot be read at all.
DydSurvey survey_dyd(const std::filesystem::path& file);
/// The same from a text; `name` stands for the file in messages.
DydSurvey parse_dyd_survey(const std::string& text, const std::string& name);

/// The records of a survey with models left out or read as others, as read_dyr does; a model may be given by
/// its name in the .dyd or in the .dyr. Throws InputError with the file's faults.
std::vector<DyrRecord> chosen_records(const DydSurvey& survey, const std::string& name,
                                      const DyrOptions& options);

/// Where a record's unit stands.
struct DydPlace {
  std::string bus_name;
  double kv = 0;  ///< nominal voltage of its bus [kV]
};
/// One record as a line of a .dyd; a model without counterpart becomes a problem at `where`.
std::string dyd_line(const DyrRecord& record, const DydMachine& machine, const DydPlace& place,
                     const std::string& where, Problems& problems);

/// Names of the models that have a counterpart: "genrou -> GENROU, ...".
std::string dyd_models_text();

/// Whether a file's name says it is a .dyd.
bool is_dyd(const std::filesystem::path& file);

}  // namespace swingbank::sim::formats
