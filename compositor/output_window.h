// SPDX-License-Identifier: Apache-2.0
#pragma once
// Where a band of samples lies in a picture of another size. The angle of view is that of the
// height: a picture of other proportions shows less or as much at its sides, never more. Pure.

#include "common/base/types.h"
#include "common/tile/filter.h"

namespace goldthread {

/// The rows of a picture of `size` that `band` of an image covers; all bands together cover it.
PixelRect band_of_size(const PixelRect& band, ImageSize image, ImageSize size);

/// What `rect`, rows of a picture of `size`, shows of the band, in the band's pixels.
SourceWindow window_of(const PixelRect& band, ImageSize image, const PixelRect& rect,
                       ImageSize size);

}  // namespace goldthread
