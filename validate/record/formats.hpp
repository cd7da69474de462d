#pragma once
// One function per kind of file that read_record knows; parse_record (record.hpp) is the one for text.
#include <filesystem>
#include <string>
#include <string_view>

#include "validate/record/comtrade.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {

/// A COMTRADE record of phasors (channels named and with units as columns of text) or of three-phase
/// waveforms, which become positive-sequence phasors; power out of the machine is V conj(I) of them. Needs
/// base.kv for waveforms and kV. Throws InputError.
Record record_of_comtrade(const Comtrade& comtrade, const std::string& name, const RecordBase& base,
                          const ReadOptions& options);

/// One plant of a run that `swingbank simulate --out FILE.h5` wrote (docs/reference/formats.md): P and Q from
/// the machine's base to the record's. Throws InputError.
Record read_hdf5_record(const std::filesystem::path& file, const RecordBase& base,
                        const ReadOptions& options);

/// A MATLAB file (v4, v5, v7.3): vectors, matrices with a list of names, and structs of them become columns,
/// which are then read as those of text; lines in messages count samples from 2 on. Throws InputError, also
/// where the file is cut short.
Record read_mat_record(const std::filesystem::path& file, const RecordBase& base, const ReadOptions& options);

/// Bytes of a file; throws InputError if it cannot be read.
std::string read_bytes(const std::filesystem::path& file);

}  // namespace swingbank::validate::record
