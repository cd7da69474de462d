#include "sim/formats/detail/dyd_models.hpp"

#include <algorithm>
#include <array>

namespace swingbank::sim::formats::dyd {
namespace {

using enum Use;

// Sources of the columns' names and order. Files of thadhaines/PSLTDSim: [1]
// tests/dydParse/sixMachineGENERICmodels.dyd (excerpts of a WECC case), [2] verification/GE4machine/g4_a.dyd
// (written by PSLF, with its template), [3] testCases/200201-sunset/sixMachineLTD.dyd, [4] epctemp.dyd. [5]
// PowerWorld's help on EXST1_GE.

constexpr Column kGenrou[] = {  // [1], [2]
    {"tpdo", value, 0}, {"tppdo", value, 1},     {"tpqo", value, 2},  {"tppqo", value, 3},
    {"h", value, 4},    {"d", value, 5},         {"ld", value, 6},    {"lq", value, 7},
    {"lpd", value, 8},  {"lpq", value, 9},       {"lppd", value, 10}, {"ll", value, 11},
    {"s1", value, 12},  {"s12", value, 13},      {"ra", resistance},  {"rcomp", off},
    {"xcomp", off},     {"accel", free, -1, 0.5}};
constexpr Column kGentpf[] = {  // [1]
    {"tpdo", value, 0},  {"tppdo", value, 1}, {"tpqo", value, 2}, {"tppqo", value, 3},     {"h", value, 4},
    {"d", value, 5},     {"ld", value, 6},    {"lq", value, 7},   {"lpd", value, 8},       {"lpq", value, 9},
    {"lppd", value, 10}, {"lppq", value, 11}, {"ll", value, 12},  {"s1", value, 13},       {"s12", value, 14},
    {"ra", resistance},  {"rcomp", off},      {"xcomp", off},     {"accel", free, -1, 0.5}};
constexpr Column kNoKis[] = {{"kis", value, 15, 0.0}};
constexpr Column kGentpj[] = {  // [1]
    {"tpdo", value, 0}, {"tppdo", value, 1}, {"tpqo", value, 2},       {"tppqo", value, 3},
    {"h", value, 4},    {"d", value, 5},     {"ld", value, 6},         {"lq", value, 7},
    {"lpd", value, 8},  {"lpq", value, 9},   {"lppd", value, 10},      {"lppq", value, 11},
    {"ll", value, 12},  {"s1", value, 13},   {"s12", value, 14},       {"ra", resistance},
    {"rcomp", off},     {"xcomp", off},      {"accel", free, -1, 0.5}, {"kis", value, 15}};
constexpr Column kGencls[] = {  // PSLTDSim, verification/refactor/ramp/ee554.exc.dyd
    {"h", value, 0},     {"d", value, 1}, {"ra", resistance},
    {"lppd", reactance}, {"rcomp", off},  {"xcomp", off}};

constexpr Column kExst4b[] = {  // [2]
    {"tr", value, 0},    {"kpr", value, 1},   {"kir", value, 2},    {"ta", value, 5},    {"vrmax", value, 3},
    {"vrmin", value, 4}, {"kpm", value, 6},   {"kim", value, 7},    {"vmmax", value, 8}, {"vmmin", value, 9},
    {"kg", value, 10},   {"kp", value, 11},   {"ang p", value, 16}, {"ki", value, 12},   {"kc", value, 14},
    {"xl", value, 15},   {"vbmax", value, 13}};
constexpr Column kExst1[] = {  // [5]
    {"tr", value, 0},
    {"vimax", value, 1},
    {"vimin", value, 2},
    {"tc", value, 3},
    {"tb", value, 4},
    {"ka", value, 5},
    {"ta", value, 6},
    {"vrmax", value, 7},
    {"vrmin", value, 8},
    {"kc", value, 9},
    {"kf", value, 10},
    {"tf", value, 11},
    {"tc1", off},
    {"tb1", off},
    {"vamax", open, -1, 999},
    {"vamin", open, -1, -999},
    {"xe", off},
    {"ilr", free},
    {"klr", off}};
// [6] PowerWorld's help on REXS. Up to se2, PSS/E's REXSYS has the same names in the same order (InterPSS).
constexpr Column kRexs[] = {{"tr", value, 0},
                            {"kvp", value, 1},
                            {"kvi", value, 2},
                            {"vimax", value, 3},
                            {"ta", value, 4},
                            {"tb1", value, 5},
                            {"tc1", value, 6},
                            {"tb2", value, 7},
                            {"tc2", value, 8},
                            {"vrmax", value, 9},
                            {"vrmin", value, 10},
                            {"kf", value, 11},
                            {"tf", value, 12},
                            {"tf1", value, 13},
                            {"tf2", value, 14},
                            {"fbf", value, 15},
                            {"kip", value, 16},
                            {"kii", value, 17},
                            {"tp", value, 18},
                            {"vfmax", value, 19},
                            {"vfmin", value, 20},
                            {"kh", value, 21},
                            {"ke", value, 22},
                            {"te", value, 23},
                            {"kc", value, 24},
                            {"kd", value, 25},
                            {"e1", value, 26},
                            {"se1", value, 27},
                            {"e2", value, 28},
                            {"se2", value, 29},
                            {"rcomp", off},
                            {"xcomp", off},
                            {"nvphz", off, -1, 0, "kvphz"},
                            {"kvphz", off},
                            {"flimf", value, 30},
                            {"xc", off},
                            {"vcmax", off, -1, 0, "xc"},
                            {"kefd", off},
                            {"limflg", off}};
// The four columns after EMAX are a second regulator and its limits; it is off while its time constant (the
// eighth column) is 0.
constexpr Column kSexs[] = {  // [3]
    {"ta/tb", value, 0},  {"tb", value, 1},     {"k", value, 2},        {"te", value, 3},
    {"emin", value, 4},   {"emax", value, 5},   {"kc", free, -1, 0.08}, {"tc", off},
    {"efdmin", again, 4}, {"efdmax", again, 5}, {"last", off}};

constexpr Column kTgov1[] = {  // [1], [3], [4]
    {"r", per_mva, 0}, {"t1", value, 1}, {"vmax", mva_power, 2}, {"vmin", mva_power, 3},
    {"t2", value, 4},  {"t3", value, 5}, {"dt", mva_power, 6}};
constexpr Column kIeeeg1[] = {  // [1]
    {"k", mva_power, 2},  {"t1", value, 3},     {"t2", value, 4},       {"t3", value, 5},
    {"uo", mva_power, 6}, {"uc", mva_power, 7}, {"pmax", mva_power, 8}, {"pmin", mva_power, 9},
    {"t4", value, 10},    {"k1", value, 11},    {"k2", value, 12},      {"t5", value, 13},
    {"k3", value, 14},    {"k4", value, 15},    {"t6", value, 16},      {"k5", value, 17},
    {"k6", value, 18},    {"t7", value, 19},    {"k7", value, 20},      {"k8", value, 21},
    {"db1", off},         {"eps", off},         {"db2", off},           {"gv1", off},
    {"pgv1", off},        {"gv2", off},         {"pgv2", off},          {"gv3", off},
    {"pgv3", off},        {"gv4", off},         {"pgv4", off},          {"gv5", off},
    {"pgv5", off},        {"gv6", off},         {"pgv6", off}};
constexpr Column kNoSecondUnit[] = {{"jbus", value, 0, 0.0}, {"m", value, 1, 0.0}};
constexpr Column kGgov1[] = {  // [1]
    {"r", value, 2},       {"rselect", value, 0}, {"tpelec", value, 3},  {"maxerr", value, 4},
    {"minerr", value, 5},  {"kpgov", value, 6},   {"kigov", value, 7},   {"kdgov", value, 8},
    {"tdgov", value, 9},   {"vmax", value, 10},   {"vmin", value, 11},   {"tact", value, 12},
    {"kturb", value, 13},  {"wfnl", value, 14},   {"tb", value, 15},     {"tc", value, 16},
    {"flag", value, 1},    {"teng", value, 17},   {"tfload", value, 18}, {"kpload", value, 19},
    {"kiload", value, 20}, {"ldref", value, 21},  {"dm", value, 22},     {"ropen", value, 23},
    {"rclose", value, 24}, {"kimw", value, 25},   {"pmwset", free},      {"aset", value, 26},
    {"ka", value, 27},     {"ta", value, 28},     {"db", value, 30},     {"tsa", value, 31},
    {"tsb", value, 32},    {"rup", value, 33},    {"rdown", value, 34}};
constexpr Column kTrate[] = {{"trate", rating, 29, 0.0}};
constexpr Column kHygov[] = {  // [1]; the gate is a fraction of the opening, so that only power is scaled
    {"r", value, 0},  {"rtemp", value, 1},  {"tr", value, 2},         {"tf", value, 3},
    {"tg", value, 4}, {"velm", value, 5},   {"gmax", value, 6},       {"gmin", value, 7},
    {"tw", value, 8}, {"at", mva_power, 9}, {"dturb", mva_power, 10}, {"qnl", value, 11}};

constexpr Column kIeeest[] = {  // [2]
    {"j", value, 0},      {"k", value, 1},      {"a1", value, 2},   {"a2", value, 3},   {"a3", value, 4},
    {"a4", value, 5},     {"a5", value, 6},     {"a6", value, 7},   {"t1", value, 8},   {"t2", value, 9},
    {"t3", value, 10},    {"t4", value, 11},    {"t5", value, 12},  {"t6", value, 13},  {"ks", value, 14},
    {"lsmax", value, 15}, {"lsmin", value, 16}, {"vcu", value, 17}, {"vcl", value, 18}, {"tdelay", off}};
constexpr Column kPss2a[] = {  // [2], [4]
    {"j1", value, 0},
    {"k1", value, 1},
    {"j2", value, 2},
    {"k2", value, 3},
    {"tw1", value, 6},
    {"tw2", value, 7},
    {"tw3", value, 9},
    {"tw4", value, 10},
    {"t6", value, 8},
    {"t7", value, 11},
    {"ks2", value, 12},
    {"ks3", value, 13},
    {"ks4", off, -1, 1, "ks2"},
    {"t8", value, 14},
    {"t9", value, 15},
    {"n", value, 5},
    {"m", value, 4},
    {"ks1", value, 16},
    {"t1", value, 17},
    {"t2", value, 18},
    {"t3", value, 19},
    {"t4", value, 20},
    {"vstmax", value, 21},
    {"vstmin", value, 22},
    {"a", off, -1, 1},
    {"ta", off},
    {"tb", off}};

// [7] MatlabPowerWorld_NumericalComp_FullWECC_CHJ1_RealPMU_XFMR by J. Eisenbarth; oel1_dyd.m writes the
// record.
constexpr Column kOel1[] = {{"ifdset", value, 0},  {"ifdmax", value, 1},  {"tpickup", value, 2},
                            {"runback", value, 3}, {"tmax", value, 4},    {"tset", value, 5},
                            {"ifcont", value, 6},  {"vfdflag", value, 7}, {"alarm", value, 8}};

constexpr Model kModels[] = {{"genrou", "GENROU", "mva", true, true, 14, kGenrou},
                             {"gentpj", "GENTPJU1", "mva", false, true, 16, kGentpj},
                             {"gentpf", "GENTPJU1", "mva", false, true, 16, kGentpf, kNoKis},
                             {"gencls", "GENCLS", "mva", false, true, 2, kGencls},
                             {"exst4b", "ESST4B", "", true, true, 17, kExst4b},
                             {"exst1", "EXST1", "", true, false, 12, kExst1},
                             {"rexs", "REXSYS", "", true, true, 31, kRexs},
                             {"sexs", "SEXS", "", false, true, 6, kSexs},
                             {"tgov1", "TGOV1", "mwcap", false, true, 7, kTgov1},
                             {"ieeeg1", "IEEEG1", "mwcap", true, true, 22, kIeeeg1, kNoSecondUnit},
                             {"ggov1", "GGOV1", "mwcap", true, true, 35, kGgov1, kTrate},
                             {"hygov", "HYGOV", "mwcap", false, true, 12, kHygov},
                             {"ieeest", "IEEEST", "", true, true, 19, kIeeest},
                             {"pss2a", "PSS2A", "", true, true, 23, kPss2a},
                             {"oel1", "OEL1", "", false, true, 9, kOel1}};

}  // namespace

std::span<const Model> models() { return kModels; }

bool is_no_unit(std::string_view dyd) {
  constexpr std::array<std::string_view, 22> others = {
      "ametr",  "fmetr",  "vmetr",  "imetr",  "ameta",  "fmeta", "vmeta", "gp1",
      "gp2",    "monit",  "lhfrt",  "lhvrt",  "lsdt1",  "lsdt9", "tlin1", "locti",
      "alwscc", "blwscc", "wlwscc", "zlwscc", "cmpldw", "motorw"};
  return std::ranges::find(others, dyd) != others.end();
}

}  // namespace swingbank::sim::formats::dyd
