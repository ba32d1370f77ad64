// SPDX-License-Identifier: Apache-2.0
#pragma once
// What lets a rank outlive a peer that it writes to over TCP. Open MPI's TCP writes end the process
// twice over: by SIGPIPE, and, that ignored, by trying again for ever after EPIPE. The reading side
// of a lost connection copes. So a write that finds the peer gone, or out of reach for so long that
// TCP has given it up, says "not now" (EAGAIN), and Open MPI leaves it to the reading side to
// notice.

namespace goldthread {

/// Ignores SIGPIPE in this process, and brings the program's own writev() with it, which must be
/// exported (--export-dynamic-symbol=writev), so that Open MPI's components find it.
void outlive_lost_peers();

}  // namespace goldthread
