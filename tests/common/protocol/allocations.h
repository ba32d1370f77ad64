// SPDX-License-Identifier: Apache-2.0
#pragma once
// Counts what this thread asks of operator new, to show that lies in a message cost no memory.

#include <cstddef>

namespace goldthread {

/// Bytes asked for by this thread since it began, whether or not they were given back.
std::size_t allocated_bytes();

}  // namespace goldthread
