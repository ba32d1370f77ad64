// SPDX-License-Identifier: Apache-2.0
#define KERNEL_UNIT cast_uint8_lit
#define KERNEL_STORAGE kUInt8
#define KERNEL_LIT true
#include "worker/kernels/kernel_unit-inl.h"
