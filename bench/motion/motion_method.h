// SPDX-License-Identifier: Apache-2.0
#pragma once
// A way to show a scene while its camera moves, as the bench of motion sees it: it is told the time
// and the newest camera, works a little, and says what that cost. Time is virtual: it advances by
// these costs, so that whatever else the bench computes disturbs nothing.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/error/statistics.h"
#include "common/scene/scene.h"

namespace goldthread::bench {

/// Displayed colours, row by row from the top.
struct ShownPicture {
  std::shared_ptr<const std::vector<Color>> colors;
  double input_seconds = 0;  ///< when the newest camera that is seen in it came
};

struct WorkDone {
  double seconds = 0;                 ///< of the whole machine; greater than 0
  std::optional<ShownPicture> shown;  ///< on the screen when they have passed
};

/// The name of the method that the others are there to be compared with.
inline constexpr const char* kInterruptible = "interruptible";

class MotionMethod {
 public:
  virtual ~MotionMethod() = default;
  virtual std::string name() const = 0;
  /// Some milliseconds of work at most, but for a method that cannot be interrupted. Deterministic
  /// but for the costs.
  virtual WorkDone work(double now_seconds, const Camera& newest) = 0;
};

}  // namespace goldthread::bench
