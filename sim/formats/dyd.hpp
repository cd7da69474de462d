#pragma once
// Reader and writer of PSLF .dyd files. Models that have a counterpart in a .dyr are converted to .dyr
// records.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/formats/psse.hpp"

namespace swingbank::sim::formats {

/// Machine data of a .dyd record that have no .dyr column; PSS/E keeps them in the .raw.
struct DydMachine {
  double mva = 0;         ///< base of the machine and of the controls that have no rating [MVA]
  double resistance = 0;  ///< armature resistance [pu]
  std::optional<double> reactance = {};  ///< X'd of a classical machine [pu]
};

/// Readable records of a .dyd, and the errors of the rest.
struct DydSurvey {
  /// Records in .dyr form. A model without a counterpart keeps its values and has an error in its `faults`.
  DyrSurvey dyr;
  std::map<int, DydMachine> machines;      ///< by DyrRecord::line
  std::map<int, std::string> notes;        ///< by DyrRecord::line: note on converted values
  std::map<int, std::string> names;        ///< by DyrRecord::line: model name in the .dyd, in capitals
  std::map<std::string, int> passed_over;  ///< number of ignored records per model name
};

/// Reads a .dyd with records of the form "model bus "name" kV "id" : #level mva=... values". Values are in
/// the documented order, or each follows its name in quotes. A line that begins with '#' or '@' is a comment;
/// '/' at the end of a line continues the record on the next. Buses are identified by number. A governor with
/// its own rating (mwcap) is converted to the machine's base. PSLF features that the counterpart does not
/// have must be switched off; otherwise DyrRecord::faults names the feature. Meters, relays and loads are
/// ignored. Throws InputError only if the file cannot be read at all.
DydSurvey survey_dyd(const std::filesystem::path& file);
/// The same for a string; `name` replaces the file name in messages.
DydSurvey parse_dyd_survey(const std::string& text, const std::string& name);

/// Returns the records of a survey after `options` have dropped and replaced models, as in read_dyr. A model
/// may be given by its name in the .dyd or in the .dyr. Throws InputError with the file's errors.
std::vector<DyrRecord> chosen_records(const DydSurvey& survey, const std::string& name,
                                      const DyrOptions& options);

/// Bus of a unit, as written in a .dyd record.
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
