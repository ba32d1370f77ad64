// SPDX-License-Identifier: Apache-2.0
#pragma once
// Into which tiles a picture is cut so that its workers end together: enough of them, and none that
// is dear. Where the samples of a picture depend on its tiles (refinement that chooses them), a cut
// by workers or by time would make another picture on another cluster: there these are not asked.
// Pure.

#include <optional>

#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"
#include "master/cost_history.h"

namespace goldthread {

/// A thread is to get so many tiles at least, if they are of 16×16 pixels or more.
constexpr int kTilesPerThread = 16;
/// A tile is dear if it takes more than this share of what a thread has to do in all.
constexpr double kDearShare = 0.4;
/// A root that was split stays so until it has become this much cheaper than dear: a grid that
/// changes has its price.
constexpr double kStaysSplit = 0.5;

/// The largest edge of 64, 32 and 16 pixels that gives each of so many threads enough tiles; 16 if
/// none does.
int root_edge(ImageSize image, int threads);

/// What a user has chosen.
struct TileChoice {
  std::optional<int> edge;  ///< absent: by the picture, and by threads where these may count
  bool rows = false;        ///< VOL2's sample rows
};

/// How a view is to be cut, and whether its dear tiles may be split.
struct ViewCut {
  TileGrid grid;
  bool split = false;
};
/// Where samples are chosen, kRefinedEdge and nothing else. Where the picture is updated in parts,
/// nothing is split: what older frames left must fit. What the user has chosen is left as it is.
ViewCut cut_of(const TileChoice& choice, ImageSize image, Sampling sampling, Update update,
               int threads);
constexpr int kRefinedEdge = 64;

/// The roots of `before`, those that are predicted to be dear split, and those of their quarters
/// that still are. `last`: the step up to which costs count.
TileGrid split_dear(const TileGrid& before, const CostHistory& costs, Step last, int threads);

}  // namespace goldthread
