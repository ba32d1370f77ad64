// SPDX-License-Identifier: Apache-2.0
// A compositor between fake peers: what they will have said lies in its mailbox before it begins,
// so that each order of arrival is a test and no clock is needed.

#include "compositor/compositor_role.h"

#include <gtest/gtest.h>

#include <zstd.h>

#include <cstring>

#include "common/codec/bulk_link.h"
#include "common/transport/counters.h"
#include "common/transport/loopback.h"
#include "tests/compositor/packed_samples.h"

namespace goldthread {
namespace {

const TileGrid kGrid = TileGrid::squares({64, 64}, 64);
constexpr Rank kCompositor{1};

class CompositorRoleTest : public ::testing::Test {
 protected:
  void begin_session(std::uint32_t compositors = 1, Compression compression = Compression::kOff) {
    master_.to_compositor(role_, BeginSession{1, false, compositors, 0, 1, compression});
  }
  void begin_view(std::uint32_t epoch, const TileGrid& grid = kGrid) {
    BeginView view;
    view.epoch = {epoch};
    view.grid = grid;
    master_.to_compositor(role_, view);
    grid_ = grid;
  }
  /// All samples of a step's grid have the value `red`.
  void send_samples(std::uint32_t epoch, Step from, Step to, float red, std::uint32_t tile = 0) {
    send(epoch, packed_grid(grid_, {tile}, from, to, [&](float, float) {
           return Sample{red, 0, 0, 1};
         }));
  }
  void send(std::uint32_t epoch, Samples message) {
    message.epoch = {epoch};
    worker_.to_compositor(role_, std::move(message));
  }
  void collect(std::uint32_t epoch, Filter filter = Filter::kBilinear) {
    master_.to_compositor(role_, CollectBand{{epoch}, filter});
  }
  /// Lets the role work through its mailbox.
  void run() {
    master_.to_compositor(role_, Stop{});
    CompositorRole(*transports_[static_cast<std::size_t>(role_.value)]).run();
    while (auto message = master_.receive<ToMaster>()) {
      EXPECT_EQ(message->first, role_);
      received_.push_back(std::move(message->second));
    }
  }
  template <class Message>
  std::vector<const Message*> received() const {
    std::vector<const Message*> all;
    for (const ToMaster& message : received_) {
      if (const auto* found = std::get_if<Message>(&message)) all.push_back(found);
    }
    return all;
  }
  static float red_of(const BandPicture& picture, std::size_t pixel = 0) {
    float red = 0;
    std::memcpy(&red, picture.pixels.data() + 4 * sizeof red * pixel, sizeof red);
    return red;
  }

  const LoopbackNetwork network_{4};
  std::unique_ptr<Transport> transports_[4]{network_.connect({0}), network_.connect({1}),
                                            network_.connect({2}), network_.connect({3})};
  Post master_{*transports_[0]}, worker_{*transports_[3]};
  Rank role_ = kCompositor;
  TileGrid grid_ = kGrid;
  std::vector<ToMaster> received_;
};

TEST_F(CompositorRoleTest, SaysHelloFirst) {
  run();
  ASSERT_FALSE(received_.empty());
  const auto* hello = std::get_if<Hello>(&received_.front());
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->role, Role::kCompositor);
  EXPECT_EQ(hello->protocol, kProtocolVersion);
}

TEST_F(CompositorRoleTest, TellsEachStepOnceAndHandsOverItsBand) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoStep, {1}, 0.25f);
  send_samples(1, {1}, {2}, 0.25f);
  collect(1);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 2u);
  EXPECT_EQ(ready[0]->step, Step{1});
  EXPECT_EQ(ready[1]->step, Step{2});
  const auto bands = received<BandPicture>();
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0]->rect, (PixelRect{0, 0, 64, 64}));
  EXPECT_EQ(bands[0]->pixels.size(), 64u * 64 * 4 * sizeof(float));
  EXPECT_EQ(red_of(*bands[0]), 0.25f);
}

TEST_F(CompositorRoleTest, TellsAStepWhenTheLastOneMissingBeforeItComes) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoStep, {1}, 0.25f);
  send_samples(1, {2}, {3}, 0.75f);
  send_samples(1, {1}, {2}, 0.5f);
  collect(1);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 2u);
  EXPECT_EQ(ready[0]->step, Step{1});
  EXPECT_EQ(ready[1]->step, Step{3});
  EXPECT_EQ(red_of(*received<BandPicture>().at(0)), 0.75f) << "what came late is older";
}

TEST_F(CompositorRoleTest, WithABandWithoutTilesIsNeverWaitedFor) {
  begin_session(2);  // of one row of tiles, which the second one has
  begin_view(1);
  collect(1);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0]->epoch, Epoch{1});
  EXPECT_EQ(ready[0]->step, kLastStep);
  ASSERT_EQ(received<BandPicture>().size(), 1u);
  EXPECT_EQ(received<BandPicture>()[0]->pixels.size(), 0u);
}

TEST_F(CompositorRoleTest, LeavesWhatLooksBeyondABandToTheMaster) {
  begin_session();
  begin_view(1);
  send(1, packed_grid(kGrid, {0}, kNoStep, kPixelStep, [](float x, float y) {
         return Sample{x == 10.5f && y == 20.5f ? 1.0f : 0.0f, 0, 0, 1};
       }));
  collect(1, Filter::kBiquadratic);
  collect(1, Filter::kPiecewiseQuadratic);
  run();
  const auto bands = received<BandPicture>();
  ASSERT_EQ(bands.size(), 2u);
  const std::size_t pixel = 20 * 64 + 10;
  EXPECT_EQ(bands[0]->rect, (PixelRect{0, 0, 64, 64}));
  for (const BandPicture* band : bands) {
    EXPECT_EQ(red_of(*band, pixel), 1);
    EXPECT_EQ(red_of(*band, pixel + 1), 0);
  }
}

TEST_F(CompositorRoleTest, KeepsAndUsesSamplesThatOvertakeTheirBeginView) {
  begin_session();
  send_samples(1, kNoStep, {1}, 0.5f);
  begin_view(1);
  collect(1);
  run();
  ASSERT_EQ(received<BandReady>().size(), 1u);
  EXPECT_EQ(red_of(*received<BandPicture>().at(0)), 0.5f);
}

TEST_F(CompositorRoleTest, KeepsSamplesThatOvertakeTheirBeginViewAndTheOneBefore) {
  begin_session();
  send_samples(2, kNoStep, {1}, 0.5f);
  begin_view(1);
  begin_view(2);
  collect(2);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0]->epoch, Epoch{2});
  EXPECT_EQ(red_of(*received<BandPicture>().at(0)), 0.5f);
}

TEST_F(CompositorRoleTest, DropsEarlySamplesOfViewsThatNewerOnesReplace) {
  begin_session();
  send_samples(1, kNoStep, {1}, 0.1f);
  send_samples(2, kNoStep, {1}, 0.2f);
  send_samples(1, {1}, {2}, 0.1f);
  begin_view(1);
  begin_view(2);
  run();
  const auto ready = received<BandReady>();
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready[0]->epoch, Epoch{2});
}

TEST_F(CompositorRoleTest, DropsStaleSamplesAndRequests) {
  begin_session();
  begin_view(1);
  begin_view(2);
  send_samples(1, kNoStep, {1}, 0.5f);
  collect(1);
  Present stale;
  stale.epoch = {1};
  stale.size = kGrid.image;
  master_.to_compositor(kCompositor, stale);
  run();
  EXPECT_TRUE(received<BandReady>().empty());
  EXPECT_TRUE(received<BandPicture>().empty());
  EXPECT_TRUE(received<RankFailed>().empty());
}

TEST_F(CompositorRoleTest, AnswersSamplesThatDoNotFitWithRankFailedAndServesOn) {
  begin_session();
  begin_view(1);
  send(1, packed({77}, kNoStep, {1}, {{0, 0}}, {{}}));
  Samples odd{{1}, {0}, kNoStep, {1}, 25, Buffer(25 * sizeof(Sample) + 1)};
  std::memset(odd.packed.data(), 0, odd.packed.size());
  send(1, std::move(odd));
  send_samples(1, kNoStep, {1}, 0.5f);
  run();
  ASSERT_EQ(received<RankFailed>().size(), 2u);
  EXPECT_EQ(received<RankFailed>()[0]->failure.status, ExitStatus::kClusterFailed);
  EXPECT_EQ(received<BandReady>().size(), 1u);
}

TEST_F(CompositorRoleTest, AnswersAViewOrSessionThatIsNoneWithRankFailed) {
  begin_session(0);
  begin_session();
  begin_view(1, {{0, 0}, {64, 64}});
  begin_view(2, {{64, 64}, {24, 64}});
  run();
  EXPECT_EQ(received<RankFailed>().size(), 3u);
}

TEST_F(CompositorRoleTest, AnswersBytesThatAreNoMessageWithRankFailed) {
  Buffer garbage(3);
  std::memset(garbage.data(), 0xff, garbage.size());
  transports_[2]->send(kCompositor, std::move(garbage));
  run();
  ASSERT_EQ(received<RankFailed>().size(), 1u);
  EXPECT_EQ(received<RankFailed>()[0]->failure.where, "rank 2");
}

TEST_F(CompositorRoleTest, AnswersAGatewayThatCannotOpenWithRankFailed) {
  begin_session();
  master_.to_compositor(kCompositor, OpenGateway{"no such address", 0, "token"});
  run();
  EXPECT_EQ(received<RankFailed>().size(), 1u);
  EXPECT_TRUE(received<GatewayOpened>().empty());
}

TEST_F(CompositorRoleTest, CountsWhatItSent) {
  begin_session();
  begin_view(1);
  send_samples(1, kNoStep, {1}, 0.5f);
  master_.to_compositor(kCompositor, ReportCounters{});
  run();
  ASSERT_EQ(received<Counters>().size(), 1u);
  const Counters& counters = *received<Counters>()[0];
  EXPECT_GT(counters.busy_seconds, 0);
  ASSERT_EQ(counters.sent.size(), 2u);
  EXPECT_EQ(counters.sent[0].kind, "BandReady");
  EXPECT_EQ(counters.sent[1].kind, "Hello");
}

TEST_F(CompositorRoleTest, TellsWhenItComputedIfItIsAsked) {
  begin_session();
  master_.to_compositor(kCompositor, ReportCounters{false, 5});
  master_.to_compositor(kCompositor, ReportCounters{true, 7});
  run();
  ASSERT_EQ(received<Counters>().size(), 2u);
  EXPECT_FALSE(received<Counters>()[0]->activity);
  const auto& activity = received<Counters>()[1]->activity;
  ASSERT_TRUE(activity);
  EXPECT_EQ(activity->asked_us, 7u);
  EXPECT_EQ(activity->share.size(), std::size_t(BusyLog::kBins));
  EXPECT_LT(activity->age_us, 50'000u);
  EXPECT_LE(activity->now_us, microseconds_of(BusyLog::Clock::now()));
}

TEST_F(CompositorRoleTest, SamplesThatCameCompressedAreThoseThatCameRaw) {
  RowCodec codec;
  BulkLink link(kCompositor, Compression::kOn, {});
  begin_session();
  begin_view(1);
  // One overtakes its view: it is kept as it came.
  for (const std::uint32_t epoch : {2u, 1u}) {
    Samples message = packed_grid(grid_, {0}, kNoStep, {4}, [&](float x, float) {
      return Sample{x, 0, 0, float(epoch)};
    });
    message.tag = link.pack(codec, message.packed, samples_layout(message.count, true));
    ASSERT_EQ(message.tag.coding, Coding::kRows);
    send(epoch, std::move(message));
  }
  begin_view(2);
  collect(2);
  run();
  EXPECT_TRUE(received<RankFailed>().empty());
  const auto bands = received<BandPicture>();
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(red_of(*bands[0], 2), 2.5f);
}

TEST_F(CompositorRoleTest, CompressedSamplesThatAreNoneEndTheJob) {
  begin_session();
  begin_view(1);
  Samples message = packed_grid(grid_, {0}, kNoStep, {4}, [&](float, float) {
    return Sample{0, 0, 0, 1};
  });
  message.tag.coding = Coding::kRows;
  send(1, std::move(message));
  run();
  ASSERT_EQ(received<RankFailed>().size(), 1u);
  EXPECT_NE(received<RankFailed>()[0]->failure.what.find("do not fit tile 0"), std::string::npos);
}

TEST_F(CompositorRoleTest, AnswersWhatAsksForAReceipt) {
  worker_.to_compositor(role_, LinkProbe{{Coding::kRaw, 7}, Buffer(1000)});
  worker_.to_compositor(role_, LinkProbe{{Coding::kRaw, 0}, Buffer(1000)});
  begin_session();
  begin_view(1);
  Samples message = packed_grid(grid_, {0}, kNoStep, {1}, [&](float, float) {
    return Sample{0, 0, 0, 1};
  });
  message.tag.receipt = 8;
  send(1, std::move(message));
  run();
  std::vector<std::uint32_t> serials;
  while (auto answer = worker_.receive<ToWorker>())
    serials.push_back(std::get<Receipt>(answer->second).serial);
  EXPECT_EQ(serials, (std::vector<std::uint32_t>{7, 8}));
}

TEST_F(CompositorRoleTest, ABandThatIsCompressedIsTheOneThatIsNot) {
  std::vector<Buffer> pixels;
  for (const Compression compression : {Compression::kOff, Compression::kOn}) {
    received_.clear();
    begin_session(1, compression);
    begin_view(1);
    send(1, packed_grid(grid_, {0}, kNoStep, {5}, [&](float x, float y) {
           return Sample{0.01f * x, 0.01f * y, 0, 1};
         }));
    collect(1);
    run();
    const auto bands = received<BandPicture>();
    ASSERT_EQ(bands.size(), 1u);
    EXPECT_EQ(bands[0]->tag.coding, compression == Compression::kOn ? Coding::kRows : Coding::kRaw);
    Buffer& band = pixels.emplace_back(bands[0]->pixels.size());
    std::memcpy(band.data(), bands[0]->pixels.data(), band.size());
    RowCodec codec;
    ASSERT_TRUE(unpack_bulk(codec, bands[0]->tag, pixel_layout(64 * 64), band));
  }
  ASSERT_EQ(pixels[0].size(), pixels[1].size());
  EXPECT_EQ(std::memcmp(pixels[0].data(), pixels[1].data(), pixels[0].size()), 0);
}

/// The second of three compositors: what it encodes goes to the first, whom the test plays.
class PresentTest : public CompositorRoleTest {
 protected:
  PresentTest() {
    role_ = {2};
    begin_session(3);
    begin_view(1, TileGrid::squares({64, 192}, 64));
  }
  /// Every pixel of the band; red grows along a row.
  void send_slope() {
    send(1, packed_grid(grid_, {1}, kNoStep, kPixelStep, [](float x, float) {
           return Sample{x / 64, 0, 0, 1};
         }));
  }
  void present(ImageSize size, Filter filter) {
    Present message;
    message.epoch = {1};
    message.size = size;
    message.filter = filter;
    message.lossless = true;
    master_.to_compositor(role_, message);
  }
  std::vector<EncodedBand> sent_bands() {
    run();
    std::vector<EncodedBand> bands;
    Post gateway(*transports_[1]);
    while (auto message = gateway.receive<ToCompositor>())
      bands.push_back(std::move(std::get<EncodedBand>(message->second)));
    return bands;
  }
  /// Red of each pixel, row by row.
  static std::vector<int> reds_of(const EncodedBand& band) {
    const auto pixels = static_cast<std::size_t>(band.rect.width * band.rect.height);
    std::vector<std::uint8_t> rgb(3 * pixels);
    EXPECT_EQ(ZSTD_decompress(rgb.data(), rgb.size(), band.payload.data(), band.payload.size()),
              rgb.size());
    std::vector<int> reds;
    for (std::size_t i = 0; i < rgb.size(); i += 3) reds.push_back(rgb[i]);
    return reds;
  }
};

TEST_F(PresentTest, OfTheSamplesOwnSizeIsTheBand) {
  send_slope();
  present({64, 192}, Filter::kBilinear);
  const auto bands = sent_bands();
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0].image, (ImageSize{64, 192}));
  EXPECT_EQ(bands[0].rect, (PixelRect{0, 64, 64, 64}));
  EXPECT_EQ(bands[0].encoding, 2);
  const auto reds = reds_of(bands[0]);
  for (std::size_t i = 0; i < reds.size(); ++i)
    EXPECT_EQ(reds[i], int(255 * (double(i % 64) + 0.5) / 64 + 0.5)) << i;
}

TEST_F(PresentTest, OfAnotherSizeIsFilteredToIt) {
  send_slope();
  present({32, 96}, Filter::kBox);
  present({128, 384}, Filter::kBilinear);
  const auto bands = sent_bands();
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_EQ(bands[0].image, (ImageSize{32, 96}));
  EXPECT_EQ(bands[0].rect, (PixelRect{0, 32, 32, 32}));
  const auto half = reds_of(bands[0]);
  for (std::size_t i = 0; i < half.size(); ++i)
    EXPECT_EQ(half[i], int(255 * (double(i % 32) + 0.5) / 32 + 0.5)) << "the mean of two, " << i;
  EXPECT_EQ(bands[1].rect, (PixelRect{0, 128, 128, 128}));
  const auto twice = reds_of(bands[1]);
  for (std::size_t i = 0; i < twice.size(); ++i) {
    if (i % 128 == 0 || i % 128 == 127) continue;  // beyond the last centres
    EXPECT_EQ(twice[i], int(255 * (double(i % 128) + 0.5) / 128 + 0.5)) << i;
  }
}

TEST_F(PresentTest, OfOtherProportionsShowsTheMiddle) {
  send_slope();
  present({32, 192}, Filter::kBilinear);
  const auto bands = sent_bands();
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0].rect, (PixelRect{0, 64, 32, 64}));
  const auto reds = reds_of(bands[0]);
  for (std::size_t i = 0; i < reds.size(); ++i)
    EXPECT_EQ(reds[i], int(255 * (double(i % 32) + 16.5) / 64 + 0.5)) << i;
}

TEST_F(PresentTest, OfASizeThatLeavesTheBandNoRowSendsNothing) {
  send_slope();
  present({16, 1}, Filter::kBilinear);
  EXPECT_TRUE(sent_bands().empty());
  EXPECT_TRUE(received<RankFailed>().empty());
}

TEST_F(PresentTest, PassesOnWhatTheMasterSaysOfThePicture) {
  send_slope();
  const Present sent{{1}, 12, 34, 56, Filter::kBicubic, {64, 192}, false, true, 3, 7, 1.25f, {}};
  master_.to_compositor(role_, sent);
  const auto bands = sent_bands();
  ASSERT_EQ(bands.size(), 1u);
  const Present& told = bands[0].present;
  EXPECT_EQ(bands[0].encoding, 1);
  EXPECT_EQ(told.epoch, sent.epoch);
  EXPECT_EQ(told.picture, sent.picture);
  EXPECT_EQ(told.viewer, sent.viewer);
  EXPECT_EQ(told.serial, sent.serial);
  EXPECT_EQ(told.filter, sent.filter);
  EXPECT_EQ(told.size, sent.size);
  EXPECT_EQ(told.lossless, sent.lossless);
  EXPECT_EQ(told.final, sent.final);
  EXPECT_EQ(told.cine_frame, sent.cine_frame);
  EXPECT_EQ(told.cine_frames, sent.cine_frames);
  EXPECT_EQ(told.estimated_error, sent.estimated_error);
}

}  // namespace
}  // namespace goldthread
