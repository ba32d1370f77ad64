// SPDX-License-Identifier: Apache-2.0
#define KERNEL_UNIT cast_uint8
#define KERNEL_STORAGE kUInt8
#define KERNEL_LIT false
#include "worker/kernels/kernel_unit-inl.h"
