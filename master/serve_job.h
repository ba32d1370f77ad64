// SPDX-License-Identifier: Apache-2.0
#pragma once
// An interactive session: input of the driving page in, views to the cluster, pictures to the
// pages. Decisions are made in frame_policy.h; this is their shell.

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "master/cluster.h"
#include "master/frame_policy.h"
#include "master/page_messages.h"

namespace goldthread {

struct ServeRequest {
  std::string host;
  std::uint16_t port = 0;
  std::string token;
  std::optional<ImageSize> size;  ///< fixed by the user; else the page may choose
  std::function<TileGrid(ImageSize)> grid;
  /// The scene with everything chosen that it leaves open.
  std::function<Scene(const Scene&, const VolumeInfo&)> resolve;
  std::function<void(std::uint16_t port)> opened = [](std::uint16_t) {};
  std::function<void(double fraction)> progress = [](double) {};
  std::function<void(const VolumeInfo&)> loaded = [](const VolumeInfo&) {};
  std::function<void(Rank rank)> worker_lost = [](Rank) {};
  std::function<bool()> ended = [] { return false; };
};

class ServeJob {
 public:
  ServeJob(Cluster& cluster, Scene scene, ServeRequest request);
  /// Serves until request.ended().
  void run();

 private:
  /// What a page asked for and what is not being cast yet.
  struct Waiting {
    bool any = false;
    bool scene = false;  ///< the scene itself changed, not only the camera
    std::uint32_t viewer = 0;
    std::uint32_t serial = 0;
  };

  void open_gateway();
  void load();
  void on(const LevelReady& event);
  void on(const WorkerLost& event);
  void on(const BandPicture& event);
  void on(const GatewayOpened& event);
  void on(const ViewerCamera& event);
  void on(const ViewerEdit& event);
  void on(const ViewerSize& event);
  void on(const Audience& event);
  void note_input(std::uint32_t viewer, std::uint32_t serial, bool scene);
  void act();
  void begin_view();
  void show(bool final);
  void tell_status();
  FrameState frame_state() const;
  void to_pages(ToCompositor message);

  Cluster& cluster_;
  Scene scene_;  ///< the newest; resolved once the volume is loaded
  ServeRequest request_;
  VolumeInfo volume_;
  bool open_ = false;

  Waiting waiting_;
  std::uint32_t viewer_ = 0;  ///< whose input is the newest in the view being cast
  std::uint32_t serial_ = 0;
  Clock::time_point last_input_{};
  FrameState frame_;
  std::uint32_t picture_ = 0;
  std::deque<Clock::time_point> shown_at_;
  Clock::time_point last_status_{};
  SessionPulse pulse_;
  bool settled_ = false;  ///< the status of the view at rest has been told
};

}  // namespace goldthread
