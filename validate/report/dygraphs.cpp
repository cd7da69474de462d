// Chart library dygraphs (MIT licence) from Debian, embedded in the binary by the assembler.
#include "validate/report/page.hpp"

asm(".section .rodata\n"
    ".global swingbank_dygraphs_js\nswingbank_dygraphs_js:\n.incbin \"" DYGRAPHS_JS
    "\"\n.byte 0\n"
    ".global swingbank_dygraphs_css\nswingbank_dygraphs_css:\n.incbin \"" DYGRAPHS_CSS
    "\"\n.byte 0\n"
    ".previous\n");
extern "C" const char swingbank_dygraphs_js[], swingbank_dygraphs_css[];

namespace swingbank::validate::report {

std::string_view dygraphs_script() {
  // The last line refers to a source map, which an offline page must not request.
  const std::string_view all = swingbank_dygraphs_js;
  return all.substr(0, all.find("//# sourceMappingURL"));
}
std::string_view dygraphs_style() {
  const std::string_view all = swingbank_dygraphs_css;
  return all.substr(0, all.find("/*# sourceMappingURL"));
}

}  // namespace swingbank::validate::report
