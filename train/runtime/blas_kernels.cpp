#include "train/runtime/blas_kernels.hpp"

#include <ATen/Version.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "base/own_executable.hpp"
#include "base/problem.hpp"
#include "train/runtime/blas_check.hpp"

namespace swingbank::train::runtime {
namespace {

constexpr const char* kAsked = "OPENBLAS_CORETYPE";
constexpr const char* kAlone =
    "SWINGBANK_OPENBLAS_ALONE";  // passes OpenBLAS's own choice to the restarted program

/// Instruction sets in order of speed.
enum class Width { sse, avx, avx2, avx512 };
constexpr std::array<std::string_view, 4> kWidthNames = {"SSE", "AVX", "AVX2", "AVX-512"};

struct Core {
  std::string_view name;
  Width width;
  bool fma4 = false;
};
/// Names of OpenBLAS 0.3's x86-64 kernels (driver/others/dynamic.c). kNarrow lists the SSE kernels.
constexpr std::array<Core, 10> kWide = {{{"Sandybridge", Width::avx},
                                         {"Bulldozer", Width::avx, true},
                                         {"Piledriver", Width::avx, true},
                                         {"Steamroller", Width::avx, true},
                                         {"Excavator", Width::avx, true},
                                         {"Haswell", Width::avx2},
                                         {"Zen", Width::avx2},
                                         {"SkylakeX", Width::avx512},
                                         {"Cooperlake", Width::avx512},
                                         {"SapphireRapids", Width::avx512}}};
constexpr std::array<std::string_view, 16> kNarrow = {
    "Katmai",     "Coppermine", "Northwood", "Prescott", "Banias",       "Atom",      "Core2",  "Penryn",
    "Dunnington", "Nehalem",    "Athlon",    "Opteron",  "Opteron_SSE3", "Barcelona", "Bobcat", "Nano"};

/// Returns the kernels of this name; nullptr for a name that only a later version of OpenBLAS has. The
/// library's own choice is then kept and measured.
const Core* core_of(std::string_view name) {
  static constexpr Core narrow{"", Width::sse};
  for (const Core& core : kWide)
    if (core.name == name) return &core;
  return std::find(kNarrow.begin(), kNarrow.end(), name) != kNarrow.end() ? &narrow : nullptr;
}

Width widest(const Processor& p) {
  return p.avx512 ? Width::avx512 : p.avx2 ? Width::avx2 : p.avx ? Width::avx : Width::sse;
}

std::string_view name_of(Width width) { return kWidthNames[static_cast<std::size_t>(width)]; }

using Text = char* (*)();
Text blas_function(const char* name) { return reinterpret_cast<Text>(dlsym(RTLD_DEFAULT, name)); }

std::string environment(const char* name) {
  const char* text = std::getenv(name);
  return text ? text : "";
}

/// Restarts the program. Returns only on failure, with the reason.
std::string restart(const std::string& asked, const std::string& alone, char** argv) {
  std::error_code error;
  // Resolves the program's path, because `ps` would show /proc/self/exe as the program's name.
  const auto program = own_executable(error);
  setenv(kAsked, asked.c_str(), 1);
  setenv(kAlone, alone.c_str(), 1);
  std::fflush(nullptr);
  if (!error) execv(program.c_str(), argv);
  const std::string why = error ? error.message() : std::strerror(errno);
  unsetenv(kAsked);
  unsetenv(kAlone);
  return why;
}

void warn(const std::string& sentence) {
  if (!sentence.empty()) fmt::print(stderr, "warning: {}\n", sentence);
}

}  // namespace

std::string tensor_instructions() {
  const std::string text = at::show_config();
  const std::string key = "CPU capability usage: ";
  const auto begin = text.find(key);
  if (begin == std::string::npos) return "unknown";
  return text.substr(begin + key.size(), text.find('\n', begin) - begin - key.size());
}

Processor Processor::here() {
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
  return {__builtin_cpu_supports("avx") != 0, avx2, avx2 && avx512, __builtin_cpu_supports("fma4") != 0};
}

BlasFound BlasFound::here() {
  const Text core = blas_function("openblas_get_corename");
  return {core ? core() : "", environment(kAsked), environment(kAlone)};
}

BlasChoice choose_blas_kernels(const Processor& processor, const BlasFound& found) {
  if (found.core.empty())
    return {"", Problem{"a library that is not OpenBLAS", "BLAS", "training may be several times slower",
                        "install libopenblas0-openmp"}
                    .sentence()};
  const Core* core = core_of(found.core);
  if (!core) return {};
  const Width best = widest(processor);
  if (core->width > best || (core->fma4 && !processor.fma4))
    throw InputError(
        {fmt::format("{} kernels", found.core), fmt::format("{}={}", kAsked, found.asked),
         fmt::format("they need instructions that this processor does not have; it has {}", name_of(best)),
         fmt::format("unset {}", kAsked)});
  if (core->width == best) return {};
  // For every processor with only AVX, the Sandybridge kernels are used, as in Debian's OpenBLAS.
  const std::string restart_with = best == Width::avx512 ? "SKYLAKEX"
                                   : best == Width::avx2 ? "HASWELL"
                                                         : "SANDYBRIDGE";
  if (found.asked.empty()) return {restart_with, ""};
  const auto slow =
      fmt::format("this processor has {}, training may take several times as long", name_of(best));
  if (!found.alone.empty())
    return {"", Problem{fmt::format("{} kernels", found.core), "OpenBLAS",
                        fmt::format("{}={} was requested; {}", kAsked, found.asked, slow),
                        "install Debian's libopenblas0-openmp, which contains all kernels"}
                    .sentence()};
  return {"", Problem{fmt::format("{} kernels ({})", found.core, name_of(core->width)),
                      fmt::format("{}={}", kAsked, found.asked), slow,
                      fmt::format("unset {}, unless these kernels are wanted", kAsked)}
                  .sentence()};
}

std::string blas_name(const BlasFound& found) {
  const Text config = blas_function("openblas_get_config");
  if (!config || found.core.empty()) return "not OpenBLAS (slow: install libopenblas0-openmp)";
  const std::string_view version = std::string_view(config()).substr(0, std::strlen("OpenBLAS 0.3.21"));
  const std::string why = !found.alone.empty()  ? fmt::format(" (chosen by OpenBLAS: {})", found.alone)
                          : found.asked.empty() ? ""
                                                : fmt::format(" (forced by {}={})", kAsked, found.asked);
  return fmt::format("{} {}{}", version, found.core, why);
}

void use_best_blas_kernels(char** argv) {
  const BlasFound found = BlasFound::here();
  const Processor processor = Processor::here();
  BlasChoice choice = choose_blas_kernels(processor, found);
  if (!choice.restart_with.empty())
    choice.warning = Problem{fmt::format("{} kernels", found.core), "OpenBLAS",
                             fmt::format("the program cannot be started again with better ones: {}",
                                         restart(choice.restart_with, found.core, argv)),
                             fmt::format("set {}={}", kAsked, choice.restart_with)}
                         .sentence();
  require_right_products(found);
  const BlasRate& rate = blas_rate();
  const std::string others = tensor_instructions();
  fmt::print(stderr, "BLAS: {}, {}; LibTorch's own loops: {}\n", blas_name(found), rate.sentence(), others);
  warn(choice.warning);
  warn(rate.warning());
  if (processor.avx2 && others == "NO AVX")
    warn(Problem{"loops without AVX2", "LibTorch", "this processor supports it", "unset ATEN_CPU_CAPABILITY"}
             .sentence());
}

}  // namespace swingbank::train::runtime
