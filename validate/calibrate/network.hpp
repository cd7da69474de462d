#pragma once
// Estimate of a trained network (`swingbank predict --json`) as a start of a calibration.
#include <filesystem>
#include <string>
#include <vector>

#include "validate/fit/fit.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::calibrate {

/// Content of an estimate file.
struct NetworkEstimate {
  std::string file, network, kind, machine,
      dataset;  ///< estimate file (JSON); file, kind, machine model and training dataset of the network
  /// Estimate of one parameter.
  struct Parameter {
    std::string name, effect, unit;  ///< name in the dataset ("H", "SEXS.K"); effect ("GENROU"); unit ("s")
    double value = 0;                ///< mean over the records [unit]
    double rms_error = 0,
           scatter = 0;        ///< RMS error on validation records; standard deviation between records [unit]
    double low = 0, high = 0;  ///< training range [unit]; equal: the parameter was constant
    /// Whether the parameter varied in the training data.
    [[nodiscard]] bool learnt() const { return high > low; }
    /// Parameter name alone, e.g. "K".
    [[nodiscard]] std::string plain() const { return sim::plant::read_parameter_name(name).parameter; }
    /// Name with its effect, e.g. "SEXS.K".
    [[nodiscard]] std::string full() const { return sim::plant::ParameterName{effect, plain()}.text(); }
  };
  std::vector<Parameter> parameters;  ///< estimated parameters
  /// A record that the estimate is based on.
  struct Seen {
    std::string record, sha256;  ///< name, and hash of its bytes
    std::vector<double> values;  ///< estimates from this record alone, in the order of `parameters`
  };
  std::vector<Seen> records;  ///< records that the estimate is based on
};

/// Reads an estimate file. Throws InputError: no such file, or not an estimate.
NetworkEstimate read_estimate(const std::filesystem::path& file);

/// Returns the plant with the network's estimates, clamped to each parameter's search range. Throws
/// InputError if the network was trained for another machine model or for an effect that the plant lacks.
/// Also throws it if a value of the plant is more than three prior standard deviations (`prior_sd`, relative)
/// outside the range of the training data.
sim::plant::Plant estimated_plant(const NetworkEstimate& estimate, const plant::PlantModel& model,
                                  double prior_sd);

/// Throws InputError if the estimate is based on a held-out event.
void require_unseen(const NetworkEstimate& estimate, const std::vector<record::Record>& records,
                    const std::vector<bool>& held_out);

}  // namespace swingbank::validate::calibrate
