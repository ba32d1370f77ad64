// SPDX-License-Identifier: Apache-2.0
#pragma once
// The exported functions of the kernel units, one per .cpp file. Only kernel_table.cpp calls them.

#include "worker/kernels/kernel_table.h"

namespace goldthread {

CastCounts cast_uint8(Features features, const CastArguments& arguments);
CastCounts cast_uint8_lit(Features features, const CastArguments& arguments);
CastCounts cast_uint16(Features features, const CastArguments& arguments);
CastCounts cast_uint16_lit(Features features, const CastArguments& arguments);
CastCounts cast_float32(Features features, const CastArguments& arguments);
CastCounts cast_float32_lit(Features features, const CastArguments& arguments);

}  // namespace goldthread
