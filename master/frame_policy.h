// SPDX-License-Identifier: Apache-2.0
#pragma once
// When a picture is shown and when a newer view takes over. Pure: values in, a decision out. Later
// the temporal error of a moving view decides; now a time budget does: while input is waiting a
// view is refined only as far as the budget allows, and shown once.

#include <chrono>
#include <cstdint>

namespace goldthread {

struct FrameState {
  bool input_waiting = false;   ///< a newer camera, scene or size than the one being cast
  bool moving = false;          ///< there was input just now, more is likely
  bool audience_ready = false;  ///< a page could take a picture at once
  bool better_ready = false;    ///< the compositors hold a whole level that is not shown yet
  bool shown = false;           ///< some level of this view has been shown
  bool finished = false;        ///< the last level is complete
  bool final_shown = false;     ///< and has been shown without loss
  std::chrono::microseconds elapsed{0};     ///< since the view began
  std::chrono::microseconds next_level{0};  ///< predicted time for the next level
};

enum class FrameAction : std::uint8_t {
  kRefine,         ///< go on with this view
  kShow,           ///< show what is complete, and go on
  kShowFinal,      ///< show the finished picture without loss
  kShowAndSwitch,  ///< show what is complete, then begin the newest view
  kSwitch          ///< begin the newest view at once
};

/// A view that moves gets this long before its first picture is shown and the next one begins.
constexpr std::chrono::microseconds kMovingBudget{33000};
/// Input counts as a movement for this long.
constexpr std::chrono::microseconds kMovementPause{150000};

FrameAction decide(const FrameState& state);

}  // namespace goldthread
