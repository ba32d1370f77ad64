// SPDX-License-Identifier: Apache-2.0
#pragma once
// A frame's messages of samples with MPI's own calls: the most that a transport over MPI could do.

#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/tile/tile_grid.h"

namespace goldthread::bench {

/// Where `bench frames` and `bench stream` leave their results.
constexpr const char* kFramesFile = "frames.json";
constexpr const char* kStreamFile = "stream.json";

struct StreamResult {
  double bytes = 0;             ///< of a round
  std::vector<double> seconds;  ///< of each round

  /// By the median round; 0 if there was none.
  double bytes_per_second() const;
};

/// Messages as large as those of a whole tile's samples in frames.h, as many for each frame, and
/// frames until a round takes a while. In all ranks of an MPI job; the result is rank 0's. Throws
/// FatalError.
StreamResult run_stream(const TileGrid& grid, int compositors, bool quick);

std::string stream_json(const StreamResult& result);
Result<StreamResult> parse_stream(const std::string& json, const std::string& where);

}  // namespace goldthread::bench
