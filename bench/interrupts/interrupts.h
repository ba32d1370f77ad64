// SPDX-License-Identifier: Apache-2.0
#pragma once
// How soon workers let go of a view: real roles in one process, interrupted at random moments by
// cameras that move, beside what a worker casts between two looks at whether it is still wanted.

#include <vector>

#include "bench/error/bench_error.h"
#include "bench/error/report.h"

namespace goldthread::bench {

/// At twice the subject's size, for the cheapest look and for the dearest. Takes `count` times 30
/// ms for each. Throws FatalError.
std::vector<InterruptRow> measure_interrupts(const Subject& subject, int count,
                                             const ErrorBenchSettings& settings);

}  // namespace goldthread::bench
