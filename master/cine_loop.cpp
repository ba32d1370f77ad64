// SPDX-License-Identifier: Apache-2.0
#include "master/cine_loop.h"

namespace goldthread {

std::vector<Camera> rocking_cameras(const Camera& rest, int frames, double swing_deg) {
  const int middle = frames / 2;
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<std::size_t>(frames));
  for (int i = 0; i < frames; ++i) {
    // The middle is turned by 0, which orbit() leaves as it is to the bit.
    cameras.push_back(middle == 0 ? rest : orbit(rest, swing_deg * (i - middle) / middle));
  }
  return cameras;
}

std::vector<int> rendering_order(int frames) {
  const int middle = frames / 2;
  std::vector<int> order{middle};
  for (int out = 1; out <= middle; ++out) {
    order.push_back(middle - out);
    order.push_back(middle + out);
  }
  return order;
}

void CineLoop::begin(const Camera& rest, int frames, double swing_deg) {
  cameras_ = rocking_cameras(rest, frames, swing_deg);
  order_ = rendering_order(frames);
  done_ = 0;
}

void CineLoop::reset() {
  cameras_.clear();
  order_.clear();
  done_ = 0;
}

void CineLoop::frame_done() {
  if (done_ < order_.size()) ++done_;
}

std::optional<int> CineLoop::frame() const {
  if (done_ >= order_.size()) return {};
  return order_[done_];
}

const Camera& CineLoop::camera() const { return cameras_[static_cast<std::size_t>(order_[done_])]; }

}  // namespace goldthread
