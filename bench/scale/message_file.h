// SPDX-License-Identifier: Apache-2.0
#pragma once
// Measured messages as a file: the ranks of an MPI job write it, the bench reads it.

#include <string>

#include "bench/scale/message_times.h"
#include "common/base/result.h"

namespace goldthread::bench {

std::string link_json(const MeasuredLink& link);
/// From the text of a file that may be anything; `where` is its name.
Result<MeasuredLink> read_link(const std::string& text, const std::string& where);

}  // namespace goldthread::bench
