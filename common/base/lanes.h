// SPDX-License-Identifier: Apache-2.0
#pragma once
// A pixel's four numbers in one register of every x86-64 and ARMv8.

#include <cstdint>
#include <cstring>

namespace goldthread {

using Lanes = float __attribute__((vector_size(16)));
/// Of comparisons: −1 where they hold, else 0.
using LaneInts = std::int32_t __attribute__((vector_size(16)));

/// From 16 bytes at any address, four floats.
inline Lanes load_lanes(const void* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

inline void store_lanes(void* to, Lanes lanes) { std::memcpy(to, &lanes, sizeof lanes); }

}  // namespace goldthread
