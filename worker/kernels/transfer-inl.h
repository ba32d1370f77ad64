// SPDX-License-Identifier: Apache-2.0
// Colour and extinction of a value, from the committed table.

#if defined(GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#undef GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#else
#define GOLDTHREAD_WORKER_KERNELS_TRANSFER_INL_H_
#endif

#include "worker/kernels/kernel_types.h"
#include "worker/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace goldthread::HWY_NAMESPACE {

struct Optics {
  Floats3 color;
  Floats extinction;  ///< 1/mm
};

/// `value` must be finite.
HWY_INLINE Optics look_up(const TransferTable& table, Floats value) {
  const Floats exact = hn::Mul(hn::Sub(value, hn::Set(kFloats, table.first_value)),
                               hn::Set(kFloats, table.rows_per_value));
  const Floats place = hn::Min(hn::Max(exact, hn::Zero(kFloats)), hn::Set(kFloats, table.last_row));
  const Ints row =
      hn::Min(hn::ConvertTo(kInts, place), hn::Set(kInts, std::int32_t(table.last_row) - 1));
  const Floats fraction = hn::Sub(place, hn::ConvertTo(kFloats, row));
  const Ints index = hn::ShiftLeft<2>(row);
  const auto column = [&](int c) HWY_ATTR {
    return lerp(hn::GatherIndex(kFloats, table.rows + c, index),
                hn::GatherIndex(kFloats, table.rows + 4 + c, index), fraction);
  };
  return {{column(0), column(1), column(2)}, column(3)};
}

}  // namespace goldthread::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
