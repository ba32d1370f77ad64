// SPDX-License-Identifier: Apache-2.0
#pragma once
// A compositor rank: keeps the samples of its band, tells the master when it has taken a step,
// encodes it when told to. The first one also runs the gateway, through which input reaches the
// master and pictures reach the pages. Knows neither how a sample came to be nor who asked for it.

#include <memory>
#include <optional>
#include <vector>

#include "common/codec/bulk_link.h"
#include "common/transport/heartbeat.h"
#include "common/transport/post.h"
#include "compositor/aged_band.h"
#include "compositor/gateway/gateway.h"
#include "compositor/picture_assembly.h"
#include "compositor/sample_array.h"

namespace goldthread {

class CompositorRole {
 public:
  explicit CompositorRole(Transport& transport);
  /// Serves until the master says stop. What fails is told to the master, which ends the job. True
  /// if no rank was lost meanwhile.
  bool run();

 private:
  void on(const BeginSession& message);
  void on(const BeginView& message);
  void on(Samples message);
  void on(const Present& message);
  void on(const CollectBand& message);
  void on(EncodedBand message);
  void on(OpenGateway message);
  void on(Welcome message);
  void on(Broadcast message);
  void on(Reply message);
  void on(const ReportCounters& message);
  void on(const Receipt& message);
  void on(const LinkProbe&) {}
  void on(const Stop& message);
  void place(Samples message);
  void probe_link();
  /// To the master, if all tiles have taken another one.
  void tell_step();
  void keep_early(Samples message);
  /// The band's pixels, float RGBA, with what no ray was cast for filled in.
  std::vector<float> picture(Filter filter, std::span<const ViewMovement> moved) const;
  /// The rows `rect` of the picture that is to be shown, filtered: each band for itself.
  std::vector<float> picture_of(const Present& present, PixelRect rect) const;
  bool in_parts() const { return view_->update != Update::kAll; }
  void forward_input();

  Post post_;
  HeartbeatSender heartbeat_;
  std::optional<Stop> stop_;
  int compositors_ = 1;
  std::optional<BeginView> view_;
  std::optional<SampleArray> samples_;
  std::optional<AgedBand> aged_;  ///< of views that are updated in parts
  Step told_step_ = kNoStep;
  /// Samples that overtook the BeginView of their epoch, on their way from another rank. All of one
  /// epoch, the newest: it shows that the master has given up the views before.
  std::vector<Samples> early_;
  RowCodec codec_;
  std::optional<BulkLink> to_master_;
  PictureAssembly assembly_;
  std::chrono::steady_clock::duration busy_{0};
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace goldthread
