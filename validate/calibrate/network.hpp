#pragma once
// A trained network's estimate (`swingbank predict --json`) as a start of a calibration.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/fit/fit.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::calibrate {

struct NetworkEstimate {
  std::string file, network, kind, machine, dataset;  ///< file: the JSON; network: where its weights stand
  struct Parameter {
    std::string name, effect, unit;  ///< as the dataset calls it: "H", "SEXS.K"; "GENROU"; "s"
    double value = 0;                ///< mean over the records [unit]
    double spread = 0, scatter = 0;  ///< rms error on the network's validation records; between the records
    double low = 0, high = 0;        ///< learnt within; equal: held
    [[nodiscard]] bool learnt() const { return high > low; }
    /// "K".
    [[nodiscard]] std::string plain() const { return sim::plant::read_parameter_name(name).parameter; }
    /// "SEXS.K".
    [[nodiscard]] std::string full() const { return sim::plant::ParameterName{effect, plain()}.text(); }
  };
  std::vector<Parameter> parameters;
  struct Seen {
    std::string record, sha256;  ///< name, and hash of its bytes
    std::vector<double> values;  ///< estimated from it alone, as `parameters`
  };
  std::vector<Seen> records;  ///< it was made of
};

/// Throws InputError: no such file, not an estimate.
NetworkEstimate read_estimate(const std::filesystem::path& file);

/// The plant with every estimate that it has a place for, within the bounds of its record. Throws InputError
/// that says what to do: the network was trained for another machine model or for an effect that the plant
/// lacks, or the plant's own value lies so far outside what the network was trained on, or held at, that
/// `spread` does not bridge it (three standard deviations).
sim::plant::Plant estimated_plant(const NetworkEstimate& estimate, const plant::PlantModel& model,
                                  double spread);

/// Throws InputError if the estimate was made of an event that is held out.
void require_unseen(const NetworkEstimate& estimate, const std::vector<record::Record>& records,
                    const std::vector<bool>& held_out);

}  // namespace swingbank::validate::calibrate
