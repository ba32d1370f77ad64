// SPDX-License-Identifier: Apache-2.0
#define KERNEL_UNIT cast_uint16
#define KERNEL_STORAGE kUInt16
#define KERNEL_LIT false
#include "worker/kernels/kernel_unit-inl.h"
