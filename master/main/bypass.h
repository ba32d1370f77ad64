// SPDX-License-Identifier: Apache-2.0
#pragma once
// --bypass: which roles get stubs in place of what they compute. Every message stays (VOL2's
// lesson: so the bottleneck of a parallel renderer is found).

#include <string>
#include <vector>

#include "common/cli/options.h"
#include "compositor/canvas.h"
#include "master/scheduler.h"
#include "worker/worker_role.h"

namespace goldthread {

/// By-passed, the master asks nothing of costs: each worker has its tiles, in the screen's order.
Strategy strategy_of(const Bypass& bypass);
CanvasMaker canvas_of(const Bypass& bypass);
SourceMaker source_of(const Bypass& bypass);
TileCaster caster_of(const Bypass& bypass);

/// The roles that are by-passed, by name.
std::vector<std::string> names_of(const Bypass& bypass);
/// Says in the log, if any is, that pictures show nothing.
void warn_of_bypass(const Bypass& bypass);

}  // namespace goldthread
