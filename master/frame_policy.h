// SPDX-License-Identifier: Apache-2.0
#pragma once
// When a picture is shown and when a newer view takes over: "Interruptible rendering" (Woolley,
// Luebke, Watson & Dayal 2003). A view is refined until it is later than it is coarse. Pure:
// values in, a decision out; asked again every millisecond.
//
// The front is what the pages show, the back is the view that is being refined. Once the back is
// shown it is the front as well and is refined in place, which makes one and a half buffers.

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/tile/refinement.h"

namespace goldthread {

/// What is wrong with a picture, against the newest input.
struct PictureErrors {
  int edits_behind = 0;    ///< changes of scene or size that it does not show yet
  double spatial_px = 0;   ///< how coarse it is: spatial_error_px()
  double temporal_px = 0;  ///< how late: kShiftOfMovement × temporal_error_px() of its camera
  double total_px() const { return spatial_px + temporal_px; }
};

struct FrameState {
  bool input_waiting = false;          ///< a newer camera, scene or size than the back's
  bool audience_ready = false;         ///< a page could take a picture at once
  bool cine_wanted = false;            ///< the pages want a cine loop that is not rendered yet
  bool has_picture = false;            ///< the back has taken its first step everywhere
  bool shown = false;                  ///< the front is the back, as coarse as it was then
  std::optional<PictureErrors> front;  ///< nothing before the first picture of a session
  PictureErrors back;
  double estimated_error = 0;         ///< of the back's colours, RMS in 1/255
  double target_error = 0;            ///< what is good enough to be shown without loss
  bool enough = false;                ///< no further step is wanted, whatever the error
  std::optional<double> final_error;  ///< estimated_error when the back was shown without loss
  std::chrono::microseconds since_begun{0};  ///< that the back is refined
  std::chrono::microseconds since_input{0};
  std::chrono::microseconds since_shown{0};
};

enum class FrameAction : std::uint8_t {
  kRefine,         ///< go on with the back
  kShow,           ///< show the back, and go on with it
  kShowFinal,      ///< show it without loss, and go on with it
  kShowAndSwitch,  ///< show the back, then begin the newest view
  kSwitch,         ///< begin the newest view at once
  kCine            ///< the picture is as it should be: begin the cine loop
};

/// More pictures than the fastest displays show would be lost; pages say when they are ready.
constexpr std::chrono::microseconds kShowInterval{1'000'000 / 120};
/// What a movement looks fluid with.
constexpr std::chrono::microseconds kFluidInterval{1'000'000 / 60};
/// Input counts as a movement for this long: then more of it is likely.
constexpr std::chrono::microseconds kMovementPause{150'000};
/// A view that is refined is shown again when its error has fallen to this share.
constexpr double kWorthShowing = 0.7071067811865476;
/// And without loss, to this one.
constexpr double kWorthShowingFinal = 0.5;

FrameAction decide(const FrameState& state);

/// How a view that is begun during a movement is to be cast, where pages want `chosen` and a ray in
/// each pixel is known to take about `whole`. All pixels at once, if that is fluid: refinement
/// would not come as far by then, since rays side by side are several times as fast as its
/// scattered ones. At rest the view begins anew and is refined.
Update update_in_motion(Update chosen, std::optional<std::chrono::microseconds> whole);

/// How long a ray in each pixel will take, at most, from the time of the first two steps.
std::chrono::microseconds whole_after(std::chrono::microseconds coarse);

}  // namespace goldthread
