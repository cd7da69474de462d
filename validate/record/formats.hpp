#pragma once
// Readers of the file formats that read_record supports; parse_record (record.hpp) reads text.
#include <filesystem>
#include <string>
#include <string_view>

#include "validate/record/comtrade.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// Returns the record of a COMTRADE file with phasors (channels named as text columns, with units) or
/// three-phase waveforms, which are converted to positive-sequence phasors. P and Q of waveforms, and of
/// phasors without recorded P and Q, are 3 V conj(I) out of the machine. Waveforms and values in kV require
/// base.kv. Throws InputError.
Record record_of_comtrade(const Comtrade& comtrade, const std::string& name, const RecordBase& base,
                          const ReadOptions& options);

/// Returns the record of one plant from a file of `swingbank simulate --out FILE.h5`
/// (docs/reference/formats.md). P and Q are converted from the machine's base to the record's. Throws
/// InputError.
Record read_hdf5_record(const std::filesystem::path& file, const RecordBase& base,
                        const ReadOptions& options);

/// Returns the record of a MATLAB file (v4, v5, v7.3). Vectors, matrices with a list of names, and structs of
/// these become text columns. In messages, the first sample is line 2. Throws InputError, also for truncated
/// files.
Record read_mat_record(const std::filesystem::path& file, const RecordBase& base, const ReadOptions& options);

/// Returns the record of a PSCAD run, whose .inf is `source.config`. The channels are read like text columns.
/// Their names and units are those of the .inf, with the group if several channels have the same name. Throws
/// InputError with the problems of the .inf and of all .out files.
Record read_pscad_record(const SourceFile& source, const RecordBase& base, const ReadOptions& options);

/// Returns the bytes of a file; throws InputError if it cannot be read.
std::string read_bytes(const std::filesystem::path& file);

}  // namespace swingbank::validate::record
