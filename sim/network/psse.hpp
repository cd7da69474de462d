#pragma once
// PSS/E .raw (versions 32 and 33) and .dyr files.
#include <filesystem>
#include <string>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim {

/// Reads a .raw file. Throws InputError with every fault of the file, each with its line number.
///
/// Read: header, bus, load, fixed shunt, generator, branch, transformer with two windings (CW 1-3, CZ 1-3, CM
/// 1-2), switched shunt (BINIT as a fixed shunt, its steps and control are not modelled). Passed over,
/// because they change nothing in the equations: area, zone, owner, inter-area transfer, impedance correction
/// tables that no transformer uses, multi-section line groupings, ratings, voltage limits, tap and load-flow
/// controls (taps stay where they are). Refused, naming section and line: dc lines, FACTS and GNE devices,
/// induction machines, three-winding transformers, transformers with a correction table, generators with a
/// step-up transformer (XT) or remote regulation. Reactive limits are kept but not enforced. Out-of-service
/// loads and shunts are left out; what stands at an isolated bus (type 4) is out of service, as in PSS/E.
///
/// Defaults of PSS/E for fields left empty: bus BASKV 0, IDE 1, VM 1, VA 0; load and shunt ID '1', STATUS 1,
/// powers 0; generator ID '1', PG 0, QG 0, QT 9999, QB -9999, VS 1, IREG 0, MBASE = SBASE, ZR 0, ZX 1, RT 0,
/// XT 0, STAT 1; branch CKT '1', R 0, B 0, line shunts 0, ST 1; transformer K 0, CKT '1', CW 1, CZ 1, CM 1,
/// MAG1 0, MAG2 0, STAT 1, R 0, SBASE1-2 = SBASE, WINDV 1 (CW 2: BASKV), NOMV 0 (= BASKV), ANG1 0, TAB1 0;
/// SBASE 100. Everything else (bus numbers, X of branches and transformers, REV, BASFRQ) must be given.
Network read_raw(const std::filesystem::path& file);

/// Writes version 33; reading it back gives the same values to the last bit (`origin` apart). Lines come
/// first, then transformers. Throws InputError where the file cannot be written or a branch has no .raw form:
/// a tap or phase shift on a branch not marked as a transformer, charging or a far-end shunt on a
/// transformer.
void write_raw(const Network& network, const std::filesystem::path& file);

/// One record of a .dyr file, model parameters as they stand there.
struct DyrRecord {
  int bus;                ///< bus number
  std::string model, id;  ///< model in capitals
  std::vector<double> values;
  int line;  ///< where it starts
};
/// Reads a .dyr file: records end with '/', may span lines. Throws InputError with every fault, with line
/// numbers.
std::vector<DyrRecord> read_dyr(const std::filesystem::path& file);

}  // namespace swingbank::sim
