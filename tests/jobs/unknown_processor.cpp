// To be preloaded: the program sees an Intel processor of family 6, model 207 (Emerald Rapids), which Debian
// 12's OpenBLAS does not support, with all features of the real one. The kernel makes the instruction CPUID
// fault (Linux, arch_prctl(2)), and the fault's handler sets the instruction's result. Linked with -z
// initfirst, so that it runs before OpenBLAS. Exits with 77 if the processor does not support such faults.
#include <asm/prctl.h>
#include <cpuid.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <csignal>

namespace {

bool allow_cpuid(bool allowed) { return syscall(SYS_arch_prctl, ARCH_SET_CPUID, allowed ? 1UL : 0UL) == 0; }

void emulate_cpuid(int signal_number, siginfo_t*, void* context) {
  greg_t* registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  const auto* code = reinterpret_cast<const unsigned char*>(registers[REG_RIP]);
  if (code[0] != 0x0f || code[1] != 0xa2) {  // not CPUID: the program itself caused the fault
    signal(signal_number, SIG_DFL);
    return;
  }
  unsigned a = 0, b = 0, c = 0, d = 0;
  const auto leaf = static_cast<unsigned>(registers[REG_RAX]);
  allow_cpuid(true);
  __cpuid_count(leaf, static_cast<unsigned>(registers[REG_RCX]), a, b, c, d);
  allow_cpuid(false);
  if (leaf == 0) {
    b = signature_INTEL_ebx;
    c = signature_INTEL_ecx;
    d = signature_INTEL_edx;
  }
  if (leaf == 1) a = 0x000c06f2;  // extended model 0xc, family 6, model 0xf, stepping 2
  registers[REG_RAX] = a;
  registers[REG_RBX] = b;
  registers[REG_RCX] = c;
  registers[REG_RDX] = d;
  registers[REG_RIP] += 2;
}

__attribute__((constructor)) void disguise() {
  struct sigaction action {};
  action.sa_sigaction = emulate_cpuid;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  if (sigaction(SIGSEGV, &action, nullptr) != 0 || !allow_cpuid(false)) _exit(77);
}

}  // namespace
