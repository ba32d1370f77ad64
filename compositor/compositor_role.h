// SPDX-License-Identifier: Apache-2.0
#pragma once
// A compositor rank: has the samples of its band kept (canvas.h), tells the master when it has
// taken a step, and has it encoded when told to. The first one also runs the gateway, through which
// input reaches the master and pictures reach the pages. Knows neither how a sample came to be nor
// who asked for it.

#include <memory>
#include <optional>
#include <vector>

#include "common/base/busy_log.h"
#include "common/codec/bulk_link.h"
#include "common/transport/heartbeat.h"
#include "common/transport/post.h"
#include "compositor/canvas.h"
#include "compositor/gateway/gateway.h"
#include "compositor/picture_assembly.h"

namespace goldthread {

class CompositorRole {
 public:
  explicit CompositorRole(Transport& transport,
                          const CanvasMaker& make_canvas = make_sample_canvas);
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
  void forward_input();

  Post post_;
  HeartbeatSender heartbeat_;
  std::optional<Stop> stop_;
  int compositors_ = 1;
  std::optional<BeginView> view_;
  std::unique_ptr<Canvas> canvas_;  ///< of the view
  Step told_step_ = kNoStep;
  /// Samples that overtook the BeginView of their epoch, on their way from another rank. All of one
  /// epoch, the newest: it shows that the master has given up the views before.
  std::vector<Samples> early_;
  RowCodec codec_;
  std::optional<BulkLink> to_master_;
  PictureAssembly assembly_;
  BusyLog busy_;
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace goldthread
