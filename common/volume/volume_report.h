// SPDX-License-Identifier: Apache-2.0
#pragma once
// What `goldthread info` says about a volume.

#include <string>

#include "common/volume/volume.h"

namespace goldthread {

/// Several lines of text, each ended by a newline and at most `columns` wide (40 at least): where
/// the volume lies, what it holds, notes, and a histogram of its values on a logarithmic scale.
/// Without statistics (a probed volume) there is no range and no histogram. With `utf8` false,
/// ASCII alone.
std::string describe(const VolumeInfo& info, int columns, bool utf8);

}  // namespace goldthread
