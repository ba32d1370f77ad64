// SPDX-License-Identifier: Apache-2.0
#pragma once
// The whole contract between roles: who may say what to whom. Each message is a value with one list
// of its fields, from which encode and decode are derived (wire.h). One variant per direction;
// roles visit it without a default branch, so that a new message breaks the build until it is
// handled. Messages of work carry the epoch of their view; whoever sees a stale one drops it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "common/base/types.h"
#include "common/protocol/buffer.h"
#include "common/protocol/codec.h"
#include "common/protocol/compression.h"
#include "common/scene/scene.h"
#include "common/tile/refinement.h"
#include "common/tile/tile_grid.h"
#include "common/volume/volume.h"

namespace goldthread {

constexpr std::uint32_t kProtocolVersion = 4;

enum class Role : std::uint8_t { kMaster, kCompositor, kWorker };

template <>
struct Enumerators<Role> {
  static constexpr std::array values{Role::kMaster, Role::kCompositor, Role::kWorker};
};
template <>
struct Enumerators<VoxelType> {
  static constexpr std::array values{VoxelType::kUInt8, VoxelType::kInt8, VoxelType::kUInt16,
                                     VoxelType::kInt16, VoxelType::kFloat32};
};
template <>
struct Enumerators<ColorSpace> {
  static constexpr std::array values{ColorSpace::kDisplay, ColorSpace::kLinear};
};
template <>
struct Enumerators<Sampling> {
  static constexpr std::array values{Sampling::kAdaptive, Sampling::kSubdivision,
                                     Sampling::kEveryPixel};
};
template <>
struct Enumerators<Filter> {
  static constexpr std::array values{Filter::kBox, Filter::kBilinear, Filter::kBiquadratic,
                                     Filter::kPiecewiseQuadratic, Filter::kBicubic};
};
template <>
struct Enumerators<Update> {
  static constexpr std::array values{Update::kAll, Update::kHalf, Update::kQuarter,
                                     Update::kFrameless, Update::kWhole};
};
/// Of a failure; kDone is none.
template <>
struct Enumerators<ExitStatus> {
  static constexpr std::array values{ExitStatus::kUsage, ExitStatus::kBadInput,
                                     ExitStatus::kClusterFailed};
};

/// How the payload of a bulk message was made shorter.
enum class Coding : std::uint8_t { kRaw, kRows };
template <>
struct Enumerators<Coding> {
  static constexpr std::array values{Coding::kRaw, Coding::kRows};
};
template <>
struct Enumerators<Compression> {
  static constexpr std::array values{Compression::kAuto, Compression::kOn, Compression::kOff};
};

/// Declares a message's name and fields; both are part of the wire format's documentation.
#define GOLDTHREAD_MESSAGE(Type, ...)         \
  static constexpr const char* kName = #Type; \
  static constexpr auto fields() { return std::tuple{__VA_ARGS__}; }

// ---- between any two ranks
// -----------------------------------------------------------------------

/// Of each message with a payload that may be coded.
struct BulkTag {
  Coding coding = Coding::kRaw;
  std::uint32_t receipt = 0;  ///< not 0: answered at once by a Receipt of it
  static constexpr auto fields() { return std::tuple{&BulkTag::coding, &BulkTag::receipt}; }
};
/// A message with that tag is here, and so are all that were sent before it.
struct Receipt {
  std::uint32_t serial = 0;
  GOLDTHREAD_MESSAGE(Receipt, &Receipt::serial)
};
/// Bytes without a meaning, sent to see how long they take.
struct LinkProbe {
  BulkTag tag;
  Buffer payload;
  GOLDTHREAD_MESSAGE(LinkProbe, &LinkProbe::tag, &LinkProbe::payload)
};

// ---- any rank to the master
// -----------------------------------------------------------------------

/// The first message of every rank. A protocol or build that differs ends the job, naming both.
struct Hello {
  std::uint32_t protocol = kProtocolVersion;
  std::string build;
  Role role = Role::kWorker;
  std::string host;  ///< for people
  std::string node;  ///< equal for ranks that can share memory
  std::uint32_t threads = 1;
  GOLDTHREAD_MESSAGE(Hello, &Hello::protocol, &Hello::build, &Hello::role, &Hello::host,
                     &Hello::node, &Hello::threads)
};

/// Memory of a process that others of its node may map: /proc/PID/fd/FD, `bytes` long.
struct SharedBlock {
  std::int32_t pid = 0;
  std::int32_t descriptor = -1;
  std::uint64_t bytes = 0;
  static constexpr auto fields() {
    return std::tuple{&SharedBlock::pid, &SharedBlock::descriptor, &SharedBlock::bytes};
  }
};

/// A rank lives; sent about once a second.
struct Heartbeat {
  std::uint8_t unused = 0;
  GOLDTHREAD_MESSAGE(Heartbeat, &Heartbeat::unused)
};
/// A worker is reading the volume: `fraction` of it is done, 0 … 1.
struct LoadProgress {
  float fraction = 0;
  GOLDTHREAD_MESSAGE(LoadProgress, &LoadProgress::fraction)
};
/// A node's reader has the volume, or a slab, in memory that its neighbours may map. Of a slab the
/// statistics are its own, without a histogram.
struct VolumeLoaded {
  VolumeInfo info;
  Slab slab;
  SharedBlock block;
  GOLDTHREAD_MESSAGE(VolumeLoaded, &VolumeLoaded::info, &VolumeLoaded::slab, &VolumeLoaded::block)
};
/// A slab's own voxels by value, answering CountVoxels.
struct VoxelCounts {
  std::vector<std::uint64_t> histogram;
  GOLDTHREAD_MESSAGE(VoxelCounts, &VoxelCounts::histogram)
};
/// A worker has mapped its node's volume.
struct VolumeMapped {
  std::uint8_t unused = 0;
  GOLDTHREAD_MESSAGE(VolumeMapped, &VolumeMapped::unused)
};
/// A worker is ready to cast rays through this revision of the scene.
struct SceneCommitted {
  std::uint32_t revision = 0;
  std::vector<std::string> features;
  std::string kernel;
  /// Places that the scene may show, in the world, mm: the same from each worker with the same
  /// slab.
  std::vector<glm::dvec3> visible_points;
  GOLDTHREAD_MESSAGE(SceneCommitted, &SceneCommitted::revision, &SceneCommitted::features,
                     &SceneCommitted::kernel, &SceneCommitted::visible_points)
};
/// A worker's first thread has begun to cast this view.
struct ViewTaken {
  Epoch epoch;
  GOLDTHREAD_MESSAGE(ViewTaken, &ViewTaken::epoch)
};
/// What is known of the pixels of a tile after some steps: sums over its pixels, each the mean of
/// the colour channels.
struct TileQuality {
  double squared_error = 0;     ///< estimated, against infinitely many samples in each pixel
  double squared_gradient = 0;  ///< squared change of colour when the picture moves by a pixel
  static constexpr auto fields() {
    return std::tuple{&TileQuality::squared_error, &TileQuality::squared_gradient};
  }
};
/// A worker has taken a tile through steps and sent the samples.
struct TileDone {
  Epoch epoch;
  TileId tile;
  Step to;
  std::uint32_t cost_us = 0;  ///< processor time that a thread spent on it
  std::uint64_t rays = 0;
  std::uint64_t samples = 0;
  TileQuality quality;
  static constexpr auto fields() {
    return std::tuple{&TileDone::epoch, &TileDone::tile,    &TileDone::to,     &TileDone::cost_us,
                      &TileDone::rays,  &TileDone::samples, &TileDone::quality};
  }
};
/// All that a worker has finished since it last looked: of quick tiles several.
struct TilesDone {
  std::vector<TileDone> tiles;
  GOLDTHREAD_MESSAGE(TilesDone, &TilesDone::tiles)
};
/// Each tile of a compositor's band has taken `step` or more.
struct BandReady {
  Epoch epoch;
  Step step;
  GOLDTHREAD_MESSAGE(BandReady, &BandReady::epoch, &BandReady::step)
};
/// A finished band over its background: float RGBA rows from the top, answering CollectBand.
struct BandPicture {
  Epoch epoch;
  PixelRect rect;
  Buffer pixels;
  BulkTag tag{};
  GOLDTHREAD_MESSAGE(BandPicture, &BandPicture::epoch, &BandPicture::rect, &BandPicture::tag,
                     &BandPicture::pixels)
};
/// What a rank has sent since the start, by kind of message, and how long it computed.
struct MessageCount {
  std::string kind;
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  static constexpr auto fields() {
    return std::tuple{&MessageCount::kind, &MessageCount::messages, &MessageCount::bytes};
  }
};
/// When a rank computed lately, by its own clock (base/busy_log.h).
struct Activity {
  std::uint64_t asked_us = 0;  ///< of the request, as it came
  std::uint64_t now_us = 0;    ///< of the answer, by the rank's own steady clock
  std::uint32_t age_us = 0;    ///< what the newest bin ends before that
  std::vector<std::uint8_t>
      share;  ///< of what its threads could, 0 … 255; a bin each, oldest first
  static constexpr auto fields() {
    return std::tuple{&Activity::asked_us, &Activity::now_us, &Activity::age_us, &Activity::share};
  }
};
/// What a rank knows of its link to another, and what it did about it. Figures are 0 where nothing
/// was measured.
struct LinkCount {
  std::int32_t to = 0;
  double bytes_per_second = 0;   ///< that the link carries
  double ratio = 0;              ///< bytes of the codec / raw bytes
  double compress_per_s = 0;     ///< raw bytes of a core
  double decompress_per_s = 0;   ///< raw bytes of a core
  std::uint64_t messages = 0;    ///< with payloads that may be coded
  std::uint64_t coded = 0;       ///< of them were
  std::uint64_t raw_bytes = 0;   ///< of their payloads
  std::uint64_t sent_bytes = 0;  ///< of their payloads, as sent
  static constexpr auto fields() {
    return std::tuple{&LinkCount::to,
                      &LinkCount::bytes_per_second,
                      &LinkCount::ratio,
                      &LinkCount::compress_per_s,
                      &LinkCount::decompress_per_s,
                      &LinkCount::messages,
                      &LinkCount::coded,
                      &LinkCount::raw_bytes,
                      &LinkCount::sent_bytes};
  }
};
struct Counters {
  std::vector<MessageCount> sent;
  std::vector<LinkCount> links;
  double busy_seconds = 0;
  std::uint64_t peak_memory_bytes = 0;  ///< of its process
  std::optional<Activity> activity;     ///< if it was asked for
  GOLDTHREAD_MESSAGE(Counters, &Counters::sent, &Counters::links, &Counters::busy_seconds,
                     &Counters::peak_memory_bytes, &Counters::activity)
};
/// A rank cannot go on: the job ends with this line and status.
struct RankFailed {
  Failure failure;
  GOLDTHREAD_MESSAGE(RankFailed, &RankFailed::failure)
};
/// The page is served at this port.
struct GatewayOpened {
  std::uint16_t port = 0;
  GOLDTHREAD_MESSAGE(GatewayOpened, &GatewayOpened::port)
};
/// Input of the driving page; `serial` counts that page's inputs.
struct ViewerCamera {
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  Camera camera;
  GOLDTHREAD_MESSAGE(ViewerCamera, &ViewerCamera::viewer, &ViewerCamera::serial,
                     &ViewerCamera::camera)
};
struct ViewerEdit {
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  std::string edit_json;
  GOLDTHREAD_MESSAGE(ViewerEdit, &ViewerEdit::viewer, &ViewerEdit::serial, &ViewerEdit::edit_json)
};
struct ViewerSize {
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  ImageSize size;
  GOLDTHREAD_MESSAGE(ViewerSize, &ViewerSize::viewer, &ViewerSize::serial, &ViewerSize::size)
};
struct ViewerDisplay {
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  DisplaySettings display;
  GOLDTHREAD_MESSAGE(ViewerDisplay, &ViewerDisplay::viewer, &ViewerDisplay::serial,
                     &ViewerDisplay::display)
};
/// How many pages look on, whether one of them could take a picture at once, and what of the
/// cluster's load any of them watches.
struct Audience {
  std::uint32_t viewers = 0;
  bool ready = false;
  bool load = false;   ///< how busy the ranks are
  bool tiles = false;  ///< who casts which tile, and how long
  GOLDTHREAD_MESSAGE(Audience, &Audience::viewers, &Audience::ready, &Audience::load,
                     &Audience::tiles)
};

using ToMaster = std::variant<Hello, Heartbeat, LoadProgress, VolumeLoaded, VoxelCounts,
                              VolumeMapped, SceneCommitted, ViewTaken, TilesDone, BandReady,
                              BandPicture, Counters, RankFailed, GatewayOpened, LinkProbe,
                              ViewerCamera, ViewerEdit, ViewerSize, ViewerDisplay, Audience>;

// ---- the master to a worker, or to a compositor
// ---------------------------------------------------

/// How the session computes; sent before anything else.
struct BeginSession {
  std::uint32_t threads = 1;  ///< compute threads of this rank
  bool interactive = false;   ///< compute only when nothing else wants the core
  std::uint32_t compositors = 1;
  std::uint32_t slabs = 0;  ///< parts of the volume; 0: each node has all of it
  std::uint32_t tiles = 1;  ///< that a worker casts at a time; with slabs most wait for others
  Compression compression = Compression::kOff;  ///< of what this rank sends
  GOLDTHREAD_MESSAGE(BeginSession, &BeginSession::threads, &BeginSession::interactive,
                     &BeginSession::compositors, &BeginSession::slabs, &BeginSession::tiles,
                     &BeginSession::compression)
};
/// Read the volume for all ranks of this node; or a slab, for those that have the same one.
struct LoadVolume {
  std::string file;
  std::int32_t component = -1;  ///< −1: the file has one, or the first
  std::uint32_t slab = 0;
  std::uint32_t slabs = 0;  ///< 0: all of it
  GOLDTHREAD_MESSAGE(LoadVolume, &LoadVolume::file, &LoadVolume::component, &LoadVolume::slab,
                     &LoadVolume::slabs)
};
/// Use the volume, or slab, that a neighbour has read.
struct MapVolume {
  VolumeInfo info;
  Slab slab;
  SharedBlock block;
  GOLDTHREAD_MESSAGE(MapVolume, &MapVolume::info, &MapVolume::slab, &MapVolume::block)
};
/// Count a slab's own voxels in 256 equal bins over the whole volume's values.
struct CountVoxels {
  double minimum = 0;
  double maximum = 0;
  GOLDTHREAD_MESSAGE(CountVoxels, &CountVoxels::minimum, &CountVoxels::maximum)
};
/// What the whole volume is like, now that all its slabs are known.
struct DescribeVolume {
  VolumeInfo info;
  GOLDTHREAD_MESSAGE(DescribeVolume, &DescribeVolume::info)
};
/// A worker is gone: what it was asked for is asked of another one with the same slab.
struct WorkerGone {
  std::uint32_t worker = 0;  ///< its index
  GOLDTHREAD_MESSAGE(WorkerGone, &WorkerGone::worker)
};
/// The resolved scene, as a scene file without defaults left open.
struct CommitScene {
  std::uint32_t revision = 0;
  std::string scene_json;
  GOLDTHREAD_MESSAGE(CommitScene, &CommitScene::revision, &CommitScene::scene_json)
};
/// A new view: everything of older epochs is dropped, but for what `update` keeps of them.
struct BeginView {
  Epoch epoch;
  std::uint32_t scene_revision = 0;
  Camera camera;
  TileGrid grid;
  Refinement refinement;
  Update update = Update::kAll;
  std::uint32_t frame = 0;  ///< which part of the samples an update casts first
  glm::dvec3 background{0};
  ColorSpace color_space = ColorSpace::kDisplay;
  GOLDTHREAD_MESSAGE(BeginView, &BeginView::epoch, &BeginView::scene_revision, &BeginView::camera,
                     &BeginView::grid, &BeginView::refinement, &BeginView::update,
                     &BeginView::frame, &BeginView::background, &BeginView::color_space)
};
/// Take a tile that has taken `from` steps to `to`.
struct RenderTile {
  Epoch epoch;
  TileId tile;
  Step from;
  Step to;
  static constexpr auto fields() {
    return std::tuple{&RenderTile::epoch, &RenderTile::tile, &RenderTile::from, &RenderTile::to};
  }
};
/// Quanta of work, in this order: all that the worker is to have for now. Each tile is reported
/// when it is done.
struct RenderTiles {
  std::vector<RenderTile> tiles;
  GOLDTHREAD_MESSAGE(RenderTiles, &RenderTiles::tiles)
};
/// Asks for Counters.
struct ReportCounters {
  bool activity = false;       ///< with when the rank computed
  std::uint64_t asked_us = 0;  ///< by the master's clock; comes back with the activity
  GOLDTHREAD_MESSAGE(ReportCounters, &ReportCounters::activity, &ReportCounters::asked_us)
};
/// The job is over. If a rank was lost, MPI can no longer be finalized: just go.
struct Stop {
  bool ranks_lost = false;
  GOLDTHREAD_MESSAGE(Stop, &Stop::ranks_lost)
};

// ---- from a worker to another one
// -----------------------------------------------------------------

/// Take rays through your slab: `count` positions (PixelPosition), then what each has gathered
/// (Sample), then, if the scene has isosurfaces, what it has met (u32).
struct AdvanceRays {
  Epoch epoch;
  std::uint32_t job = 0;   ///< the asker's number for it
  bool completes = false;  ///< mip: the exact value around the best, and done; else: gather
  std::uint32_t count = 0;
  Buffer packed;
  GOLDTHREAD_MESSAGE(AdvanceRays, &AdvanceRays::epoch, &AdvanceRays::job, &AdvanceRays::completes,
                     &AdvanceRays::count, &AdvanceRays::packed)
};
/// The answer: what they have gathered now (Sample, and u32 as asked).
struct RaysAdvanced {
  Epoch epoch;
  std::uint32_t job = 0;
  std::uint64_t taken = 0;  ///< field evaluations
  Buffer packed;
  GOLDTHREAD_MESSAGE(RaysAdvanced, &RaysAdvanced::epoch, &RaysAdvanced::job, &RaysAdvanced::taken,
                     &RaysAdvanced::packed)
};

using ToWorker = std::variant<BeginSession, LoadVolume, MapVolume, CountVoxels, DescribeVolume,
                              WorkerGone, CommitScene, BeginView, RenderTiles, AdvanceRays,
                              RaysAdvanced, ReportCounters, Receipt, Stop>;

// ---- to a compositor
// ------------------------------------------------------------------------------

/// What changed in a tile by one quantum: `count` colours (Sample), then the place of each
/// (SampleOffset), packed; of a view that is updated in parts the colours alone, in the order of
/// places_of().
struct Samples {
  Epoch epoch;
  TileId tile;
  Step from;
  Step to;
  std::uint32_t count = 0;
  Buffer packed;
  BulkTag tag{};
  GOLDTHREAD_MESSAGE(Samples, &Samples::epoch, &Samples::tile, &Samples::from, &Samples::to,
                     &Samples::count, &Samples::tag, &Samples::packed)
};
/// How far the picture has moved since an older view, by the newest camera.
struct ViewMovement {
  Epoch epoch;
  float pixels = 0;
  static constexpr auto fields() { return std::tuple{&ViewMovement::epoch, &ViewMovement::pixels}; }
};
/// Encode the band as it is and send it to the gateway as part of `picture`.
struct Present {
  Epoch epoch;
  std::uint32_t picture = 0;
  std::uint32_t viewer = 0;
  std::uint32_t serial = 0;
  Filter filter = Filter::kBilinear;
  ImageSize size;  ///< of the picture; the samples' own, or another one to filter them to
  bool lossless = false;
  bool final = false;
  std::uint8_t cine_frame = 0;      ///< 1 … cine_frames: a frame of the cine loop
  std::uint8_t cine_frames = 0;     ///< 0: no cine loop
  float estimated_error = -1;       ///< RMS in 1/255; negative: unknown
  std::vector<ViewMovement> moved;  ///< of the views whose samples an update keeps
  GOLDTHREAD_MESSAGE(Present, &Present::epoch, &Present::picture, &Present::viewer,
                     &Present::serial, &Present::filter, &Present::size, &Present::lossless,
                     &Present::final, &Present::cine_frame, &Present::cine_frames,
                     &Present::estimated_error, &Present::moved)
};
/// Send the band's pixels to the master.
struct CollectBand {
  Epoch epoch;
  Filter filter = Filter::kBilinear;  ///< of what is filled in
  GOLDTHREAD_MESSAGE(CollectBand, &CollectBand::epoch, &CollectBand::filter)
};
/// A compositor's encoded band, for the gateway to put together with the others'.
struct EncodedBand {
  Present present;
  ImageSize image;
  PixelRect rect;
  std::uint8_t encoding = 0;  ///< 1 JPEG, 2 zstd of RGB rows
  Buffer payload;
  GOLDTHREAD_MESSAGE(EncodedBand, &EncodedBand::present, &EncodedBand::image, &EncodedBand::rect,
                     &EncodedBand::encoding, &EncodedBand::payload)
};
/// Serve the page (to the first compositor).
struct OpenGateway {
  std::string host;
  std::uint16_t port = 0;
  std::string token;
  GOLDTHREAD_MESSAGE(OpenGateway, &OpenGateway::host, &OpenGateway::port, &OpenGateway::token)
};
/// JSON for the pages: what each newcomer gets first, for all, or for one.
struct Welcome {
  std::string json;
  GOLDTHREAD_MESSAGE(Welcome, &Welcome::json)
};
struct Broadcast {
  std::string json;
  GOLDTHREAD_MESSAGE(Broadcast, &Broadcast::json)
};
struct Reply {
  std::uint32_t viewer = 0;
  std::string json;
  GOLDTHREAD_MESSAGE(Reply, &Reply::viewer, &Reply::json)
};

using ToCompositor =
    std::variant<BeginSession, BeginView, Samples, Present, CollectBand, EncodedBand, OpenGateway,
                 Welcome, Broadcast, Reply, ReportCounters, Receipt, LinkProbe, Stop>;

#undef GOLDTHREAD_MESSAGE

}  // namespace goldthread
