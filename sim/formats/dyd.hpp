#pragma once
// PSLF .dyd files: reader and writer of the models that have a counterpart in a .dyr, as .dyr records.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"

namespace swingbank::sim::formats {

/// Machine data of a .dyd record that have no .dyr column; PSS/E keeps them in the .raw.
struct DydMachine {
  double mva = 0;         ///< base of the machine, and of its controls without a rating of their own [MVA]
  double resistance = 0;  ///< armature resistance [pu]
  std::optional<double> reactance = {};  ///< X'd of a classical machine [pu]
};

/// The readable records of a .dyd, and the errors of the other text.
struct DydSurvey {
  /// Records in .dyr form. A model without a counterpart keeps its values unchanged and has a fault.
  DyrSurvey dyr;
  std::map<int, DydMachine> machines;      ///< by DyrRecord::line
  std::map<int, std::string> notes;        ///< by DyrRecord::line: sentence on converted values
  std::map<int, std::string> names;        ///< by DyrRecord::line: model name in the .dyd, in capitals
  std::map<std::string, int> passed_over;  ///< number of ignored records per model name
};

/// Reads a .dyd with records of the form "model bus "name" kV "id" : #level mva=... values". Values are in
/// the documented order, or each follows its name in quotes. '#' begins a comment; '/' at the end of a line
/// continues the record on the next. Buses are identified by number. A governor with its own rating (mwcap)
/// is converted to the machine's base. PSLF features that the counterpart does not have must be switched off;
/// otherwise the record has a fault that names the feature. Meters and loads are ignored. Throws InputError
/// only if the file cannot be read at all.
DydSurvey survey_dyd(const std::filesystem::path& file);
/// The same from a text; `name` replaces the file name in messages.
DydSurvey parse_dyd_survey(const std::string& text, const std::string& name);

/// Returns the records of a survey after dropping and replacing models, as read_dyr does. A model may be
/// given by its name in the .dyd or in the .dyr. Throws InputError with the file's faults.
std::vector<DyrRecord> chosen_records(const DydSurvey& survey, const std::string& name,
                                      const DyrOptions& options);

/// Bus of a record's unit.
struct DydPlace {
  std::string bus_name;  ///< name of the bus
  double kv = 0;         ///< nominal voltage of the bus [kV]
};
/// Returns one record as a line of a .dyd. A model without a counterpart becomes a problem at `where`.
std::string dyd_line(const DyrRecord& record, const DydMachine& machine, const DydPlace& place,
                     const std::string& where, Problems& problems);

/// Returns the names of the models that have a counterpart: "genrou -> GENROU, ...".
std::string dyd_models_text();

/// Returns true if the file name has the extension .dyd.
bool is_dyd(const std::filesystem::path& file);

}  // namespace swingbank::sim::formats
