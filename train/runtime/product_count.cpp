#include "train/runtime/product_count.hpp"

#include <ATen/ATen.h>
#include <ATen/record_function.h>

#include <array>
#include <atomic>
#include <memory>
#include <string_view>

namespace swingbank::train::runtime {
namespace {

std::atomic<std::int64_t> counted{0};
thread_local int depth = 0;  // a batched product may contain single ones, which LibTorch reports too

struct Operator {
  std::string_view name;
  std::size_t factors;  ///< index of the first of two factors in its arguments
};
constexpr std::array<Operator, 6> kProducts = {{{"aten::mm", 0},
                                                {"aten::bmm", 0},
                                                {"aten::addmm", 1},
                                                {"aten::addmm_", 1},
                                                {"aten::baddbmm", 1},
                                                {"aten::baddbmm_", 1}}};

struct Entered : at::ObserverContext {};

std::unique_ptr<at::ObserverContext> begin(const at::RecordFunction& call) {
  const std::string_view name = call.name();
  for (const Operator& product : kProducts) {
    if (product.name != name) continue;
    const auto arguments = call.inputs();
    if (depth++ == 0 && arguments.size() > product.factors + 1) {
      const at::Tensor &a = arguments[product.factors].toTensor(),
                       &b = arguments[product.factors + 1].toTensor();
      counted += 2 * a.numel() * b.size(-1);  // batch x m x k times batch x k x n
    }
    return std::make_unique<Entered>();
  }
  return nullptr;
}
void end(const at::RecordFunction&, at::ObserverContext* entered) {
  if (entered) --depth;
}

}  // namespace

ProductCount::ProductCount() {
  counted = 0;
  handle_ = at::addGlobalCallback(at::RecordFunctionCallback(begin, end).needsInputs(true));
}
ProductCount::~ProductCount() { at::removeCallback(handle_); }
double ProductCount::operations() const { return static_cast<double>(counted); }

}  // namespace swingbank::train::runtime
