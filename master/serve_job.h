// SPDX-License-Identifier: Apache-2.0
#pragma once
// An interactive session: input of the driving page in, views to the cluster, pictures to the
// pages. Decisions are made in frame_policy.h; this is their shell.

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "master/cine_loop.h"
#include "master/cluster.h"
#include "master/frame_policy.h"
#include "master/load_messages.h"
#include "master/page_messages.h"
#include "master/stop_rule.h"
#include "master/tile_cut.h"

namespace goldthread {

struct ServeRequest {
  std::string host;
  std::uint16_t port = 0;
  std::string token;
  std::optional<ImageSize> size;  ///< fixed by the user; else the page may choose
  StopRule stop;                  ///< when a picture is good enough to be shown without loss
  DisplaySettings display;
  TileChoice tiles;
  /// The scene with everything chosen that it leaves open.
  std::function<Scene(const Scene&, const VolumeInfo&)> resolve;
  /// The step of its rays, mm.
  std::function<double(const Scene&, const VolumeInfo&)> step_mm;
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
  };
  /// What a picture shows.
  struct Shown {
    Camera camera;
    std::uint32_t edits = 0;  ///< changes of scene and size so far
    Epoch epoch;
    double spatial_px = 0;
    Update update = Update::kAll;
  };

  void open_gateway();
  void load();
  void on(const StepCast& event);
  void on(const StepHeld& event);
  void on(const WorkerLost& event);
  void on(const BandPicture&) {}
  void on(const GatewayOpened& event);
  void on(const ViewerCamera& event);
  void on(const ViewerEdit& event);
  void on(const ViewerSize& event);
  void on(const ViewerDisplay& event);
  void on(const Audience& event);
  void note_input(std::uint32_t viewer, std::uint32_t serial);
  /// The view must be cast anew.
  void want_view(bool scene);
  void act();
  void begin_view();
  void cast(const Camera& camera);
  void show(bool final);
  void reshow();
  void advance_cine();
  void tell_status();
  const char* phase() const;
  bool is_moving() const;
  bool has_picture() const { return cluster_.view().held > kNoStep; }
  /// Whether no step is open, since none is wanted, and the compositors hold all there are.
  bool is_paused() const { return paused_ && cluster_.view().held == cluster_.view().cast(); }
  /// Whether the samples of the view cover a picture of the wanted size.
  bool covers_size() const;
  FrameState frame_state() const;
  PictureErrors errors_of(const Shown& picture) const;
  double spatial_px() const;
  double spatial_px_of_parts() const;
  /// Whether all parts of an update are of the newest camera and scene.
  bool is_settled() const;
  std::vector<ViewMovement> movements() const;
  void to_pages(ToCompositor message);
  void commit();
  void say_welcome();

  Cluster& cluster_;
  Scene scene_;  ///< the newest; resolved once the volume is loaded
  ServeRequest request_;
  VolumeInfo volume_;
  bool open_ = false;

  Waiting waiting_;
  std::uint32_t viewer_ = 0;  ///< whose input is the newest in the view being cast
  std::uint32_t serial_ = 0;
  std::uint32_t newest_viewer_ = 0;  ///< whose input is the newest of all
  std::uint32_t newest_serial_ = 0;
  Clock::time_point last_input_{};
  std::uint32_t edits_ = 0;
  Shown back_;                  ///< what the view being cast shows
  std::optional<Shown> front_;  ///< what the pages show
  std::optional<double> final_error_;
  Update update_ = Update::kAll;  ///< of the view being cast
  /// What a ray in each pixel took last, or will take.
  std::optional<std::chrono::microseconds> whole_;
  std::deque<Shown> parts_;  ///< views whose samples an update keeps, the newest last
  bool paused_ = false;      ///< the next step is opened once the picture has been shown
  bool audience_ready_ = false;
  bool reshow_ = false;  ///< the same samples are wanted in another form
  bool again_ = false;   ///< and that without loss, from a whole step
  std::uint32_t moving_frame_ = 0;
  CineLoop cine_;
  std::uint32_t picture_ = 0;
  std::deque<Clock::time_point> shown_at_;
  Clock::time_point last_show_{};
  Clock::time_point last_status_{};
  Step told_step_;
  SessionPulse pulse_;
  LoadTeller load_;
};

}  // namespace goldthread
