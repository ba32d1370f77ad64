// SPDX-License-Identifier: Apache-2.0
#define KERNEL_UNIT cast_uint16_lit
#define KERNEL_STORAGE kUInt16
#define KERNEL_LIT true
#include "worker/kernels/kernel_unit-inl.h"
