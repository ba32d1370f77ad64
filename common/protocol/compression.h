// SPDX-License-Identifier: Apache-2.0
#pragma once
// When the payloads of bulk messages are made shorter.

#include <cstdint>

namespace goldthread {

/// Where it is measured to pay, always, or never.
enum class Compression : std::uint8_t { kAuto, kOn, kOff };

}  // namespace goldthread
