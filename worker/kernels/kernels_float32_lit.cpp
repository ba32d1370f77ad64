// SPDX-License-Identifier: Apache-2.0
#define KERNEL_UNIT cast_float32_lit
#define KERNEL_STORAGE kFloat32
#define KERNEL_LIT true
#include "worker/kernels/kernel_unit-inl.h"
