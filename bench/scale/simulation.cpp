// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/simulation.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "bench/scale/deal_chunks.h"
#include "bench/scale/scheduling.h"
#include "common/protocol/wire.h"

namespace goldthread::bench {
namespace {

struct Event {
  enum class Kind : std::uint8_t { kTileDone, kSamples, kBandReady, kPartDone, kOpenPart };
  double us = 0;
  std::uint64_t number = 0;  ///< of events at the same time the earlier one comes first
  Kind kind = Kind::kTileDone;
  int from = 0;  ///< worker or compositor; of kOpenPart the sub-master it is for
  std::uint32_t tile = 0;
  std::size_t step = 0;
  bool operator>(const Event& other) const {
    return us != other.us ? us > other.us : number > other.number;
  }
};

/// One message after the other.
struct Server {
  double free_us = 0;
  double busy_us = 0;
  std::uint64_t messages = 0;
  /// Begins a piece of work that is asked for at `at`; when it begins.
  double begin(double at) const { return std::max(at, free_us); }
  void end(double begun, double ended) {
    busy_us += ended - begun;
    free_us = ended;
  }
};

struct Thread {
  double free_us = 0;
  double computed_us = 0;
};

struct Master {
  Server server;
  Scheduling scheduling;
  MasterCosts costs;
  int first_worker = 0;
  int workers = 1;
};

struct MessageBytes {
  double order = double(encode(ToWorker(RenderTiles{})).size());  ///< without tiles
  double tile = double(encode(ToWorker(RenderTiles{{{}}})).size()) - order;
  double done = double(encode(ToMaster(TilesDone{{{}}})).size());
  double view = double(encode(ToWorker(BeginView{})).size());
  double samples = double(encode(ToCompositor(Samples{})).size());  ///< without the samples
  double small = double(encode(ToMaster(BandReady{})).size());
  double tile_number = sizeof(TileId);
};

class Simulation {
 public:
  Simulation(const FrameWork& now, const FrameWork& before, const ClusterModel& model,
             const ClusterShape& shape);
  SimulatedFrame run();

 private:
  void begin_view();
  /// The master above tells a sub-master, which hears of it at `at`.
  void open_part_at(int master, double at);
  void open_part(Master& master, double at);
  /// Quanta for a worker, which go out in one message.
  using Order = std::vector<std::vector<std::uint32_t>>;
  /// Whether there was another quantum for the worker; `now` moves on.
  bool add_quantum(Master& master, int worker, Order& order, double& now);
  /// What is in the order leaves at `now`, which moves on.
  void send(Master& master, int worker, const Order& order, double& now);
  void compute(int worker, std::span<const std::uint32_t> tiles, double at);
  void on_tile_done(const Event& event);
  void on_samples(const Event& event);
  void on_band_ready(const Event& event);
  void on_part_done(const Event& event);
  void open_next_step(double& now);
  void post(Event event) {
    event.number = ++events_posted_;
    events_.push(event);
  }
  bool two_levels() const { return shape_.masters > 1; }
  Master& master_of(int worker) {
    return masters_[std::size_t(worker / (shape_.workers / shape_.masters))];
  }
  Server& top() { return two_levels() ? top_ : masters_.front().server; }
  /// From the end of sending until it can be received.
  double transit(double bytes) const { return model_.link.transit.at(bytes); }
  double send_us(double bytes) const { return model_.link.send.at(bytes); }
  double receive_us(double bytes) const { return model_.link.receive.at(bytes); }

  const FrameWork& work_;
  const ClusterModel& model_;
  ClusterShape shape_;
  MessageBytes bytes_;
  std::vector<Master> masters_;
  Server top_;
  std::vector<Server> compositors_;
  std::vector<std::size_t> band_tiles_;
  std::vector<std::vector<std::size_t>> placed_;  ///< by step and compositor
  std::vector<Thread> threads_;                   ///< worker by worker
  std::vector<int> holder_;                       ///< of a tile's state; −1: none
  std::size_t step_ = 0;                          ///< that is open, from 0
  int parts_open_ = 0;
  std::size_t bands_open_ = 0;  ///< of the last step
  double cast_us_ = 0;          ///< when the master knew that all tiles had taken the last step
  double end_us_ = 0;
  std::uint64_t reports_ = 0;
  std::uint64_t events_posted_ = 0;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  SimulatedFrame result_;
};

Simulation::Simulation(const FrameWork& now, const FrameWork& before, const ClusterModel& model,
                       const ClusterShape& shape)
    : work_(now),
      model_(model),
      shape_(shape),
      compositors_(std::size_t(shape.compositors)),
      band_tiles_(std::size_t(shape.compositors)),
      placed_(now.steps.size(), std::vector<std::size_t>(std::size_t(shape.compositors))),
      threads_(std::size_t(shape.workers) * std::size_t(shape.threads)),
      holder_(now.grid.count(), -1) {
  const int each = shape.workers / shape.masters;
  auto parts = deal_chunks(before, shape.masters, shape.tiles_per_chunk);
  for (int m = 0; m < shape.masters; ++m)
    masters_.push_back({{},
                        Scheduling(before, std::move(parts[std::size_t(m)]), each,
                                   shape.threads + shape.spare, shape.strategy),
                        model.master_of(each),
                        m * each,
                        each});
  for (std::uint32_t tile = 0; tile < now.grid.count(); ++tile)
    ++band_tiles_[std::size_t(band_index(now.grid, {tile}, shape.compositors))];
  bands_open_ = std::size_t(
      std::count_if(band_tiles_.begin(), band_tiles_.end(), [](std::size_t n) { return n > 0; }));
}

bool Simulation::add_quantum(Master& master, int worker, Order& order, double& now) {
  const auto tiles = master.scheduling.next(worker);
  if (tiles.empty()) return false;
  now += master.costs.supply_us;
  order.emplace_back(tiles.begin(), tiles.end());
  return true;
}

void Simulation::send(Master& master, int worker, const Order& order, double& now) {
  if (order.empty()) return;
  double bytes = bytes_.order;
  for (const auto& tiles : order) bytes += bytes_.tile * double(tiles.size());
  now += send_us(bytes);
  ++master.server.messages;
  for (const auto& tiles : order)
    compute(master.first_worker + worker, tiles, now + transit(bytes) + receive_us(bytes));
}

/// The quanta of a worker come in the order in which they are sent, so each takes the thread that
/// is free first.
void Simulation::compute(int worker, std::span<const std::uint32_t> tiles, double at) {
  const auto first = threads_.begin() + std::ptrdiff_t(worker) * shape_.threads;
  Thread& thread =
      *std::min_element(first, first + shape_.threads,
                        [](const Thread& a, const Thread& b) { return a.free_us < b.free_us; });
  ++result_.quanta;
  double now = std::max(at, thread.free_us);
  for (const std::uint32_t tile : tiles) {
    double us = work_.steps[step_][tile].us;
    int& holder = holder_[tile];
    if (step_ > 0 && holder != worker) {
      ++result_.taken_over;
      for (std::size_t earlier = 0; earlier < step_; ++earlier) us += work_.steps[earlier][tile].us;
    }
    holder = worker;
    now += us;
    thread.computed_us += us;
    const double samples = bytes_.samples + work_.steps[step_][tile].bytes;
    now += send_us(samples);
    post({now + transit(samples), 0, Event::Kind::kSamples, worker, tile, step_});
    now += send_us(bytes_.done);
    post({now + transit(bytes_.done), 0, Event::Kind::kTileDone, worker, tile, step_});
  }
  thread.free_us = now;
}

void Simulation::begin_view() {
  if (!two_levels()) {
    open_part(masters_.front(), 0);
    return;
  }
  // The master above sorts the chunks, and tells each sub-master the view and its tiles.
  double now = double(work_.grid.count()) / shape_.tiles_per_chunk * masters_[0].costs.queue_us;
  for (int m = 0; m < shape_.masters; ++m) {
    const double bytes =
        bytes_.view + bytes_.tile_number * double(masters_[std::size_t(m)].scheduling.tiles());
    now += masters_[0].costs.begin_us + send_us(bytes);
    open_part_at(m, now + transit(bytes));
  }
  top_.end(0, now);
}

void Simulation::open_part_at(int master, double at) {
  ++top_.messages;
  // Of fewer chunks than masters.
  if (masters_[std::size_t(master)].scheduling.tiles() == 0) return;
  ++parts_open_;
  post({at, 0, Event::Kind::kOpenPart, master, 0, 0});
}

void Simulation::open_part(Master& master, double at) {
  const double begin = master.server.begin(at);
  double now = begin + double(master.scheduling.tiles()) * master.costs.queue_us;
  if (two_levels()) {
    now += receive_us(bytes_.view);
    ++master.server.messages;
  }
  if (step_ == 0) {
    now += master.workers * (master.costs.begin_us + send_us(bytes_.view));
    master.server.messages += std::uint64_t(master.workers);
  }
  master.scheduling.open();
  std::vector<Order> orders(std::size_t(master.workers));
  master.scheduling.supply_all(
      [&](int worker) { return add_quantum(master, worker, orders[std::size_t(worker)], now); });
  for (int worker = 0; worker < master.workers; ++worker)
    send(master, worker, orders[std::size_t(worker)], now);
  master.server.end(begin, now);
}

void Simulation::on_tile_done(const Event& event) {
  Master& master = master_of(event.from);
  const double begin = master.server.begin(event.us);
  result_.master_wait_us += begin - event.us;
  ++reports_;
  double now = begin + receive_us(bytes_.done) + master.costs.done_us;
  ++master.server.messages;
  const int worker = event.from - master.first_worker;
  master.scheduling.done(worker, event.tile, work_.steps[event.step][event.tile]);
  Order order;
  while (add_quantum(master, worker, order, now)) continue;
  send(master, worker, order, now);
  const bool finished = master.scheduling.finished();
  if (finished && two_levels()) {
    now += master.costs.supply_us + send_us(bytes_.small);
    ++master.server.messages;
    post({now + transit(bytes_.small), 0, Event::Kind::kPartDone, event.from, 0, 0});
  }
  master.server.end(begin, now);
  if (finished && !two_levels()) open_next_step(now);
}

/// Of a cluster with one master `now` is when it has nothing else to do.
void Simulation::open_next_step(double& now) {
  if (++step_ == work_.steps.size()) {
    cast_us_ = now;
    end_us_ = std::max(end_us_, now);
    return;
  }
  if (!two_levels()) {
    open_part(masters_.front(), now);
    return;
  }
  for (int m = 0; m < shape_.masters; ++m) {
    now += masters_[0].costs.supply_us + send_us(bytes_.small);
    open_part_at(m, now + transit(bytes_.small));
  }
}

void Simulation::on_part_done(const Event& event) {
  const double begin = top_.begin(event.us);
  double now = begin + receive_us(bytes_.small) + masters_[0].costs.done_us;
  ++top_.messages;
  if (--parts_open_ == 0) open_next_step(now);
  top_.end(begin, now);
}

void Simulation::on_samples(const Event& event) {
  const auto band = std::size_t(band_index(work_.grid, {event.tile}, shape_.compositors));
  Server& compositor = compositors_[band];
  const double begin = compositor.begin(event.us);
  const double samples = work_.steps[event.step][event.tile].bytes;
  double now = begin + receive_us(bytes_.samples + samples) + model_.place.at(samples);
  ++compositor.messages;
  if (++placed_[event.step][band] == band_tiles_[band]) {
    now += send_us(bytes_.small);
    post({now + transit(bytes_.small), 0, Event::Kind::kBandReady, int(band), 0, event.step});
  }
  compositor.end(begin, now);
}

void Simulation::on_band_ready(const Event& event) {
  const double begin = top().begin(event.us);
  const double now = begin + receive_us(bytes_.small) + masters_[0].costs.done_us;
  ++top().messages;
  top().end(begin, now);
  if (event.step + 1 == work_.steps.size() && --bands_open_ == 0) end_us_ = std::max(end_us_, now);
}

SimulatedFrame Simulation::run() {
  begin_view();
  while (!events_.empty()) {
    const Event event = events_.top();
    events_.pop();
    switch (event.kind) {
      case Event::Kind::kTileDone:
        on_tile_done(event);
        break;
      case Event::Kind::kSamples:
        on_samples(event);
        break;
      case Event::Kind::kBandReady:
        on_band_ready(event);
        break;
      case Event::Kind::kPartDone:
        on_part_done(event);
        break;
      case Event::Kind::kOpenPart:
        open_part(masters_[std::size_t(event.from)], event.us);
        break;
    }
  }
  result_.us = end_us_;
  result_.master_wait_us /= double(std::max<std::uint64_t>(1, reports_));
  result_.compositors_late_us = end_us_ - cast_us_;
  result_.efficiency = work_.us() / (double(threads_.size()) * end_us_);
  double most = 0, all = 0;
  for (const Thread& thread : threads_) {
    most = std::max(most, thread.computed_us);
    all += thread.computed_us;
  }
  result_.imbalance = all > 0 ? most * double(threads_.size()) / all : 1;
  std::uint64_t messages = two_levels() ? top_.messages : 0;
  for (const Master& master : masters_) {
    result_.master_busy = std::max(result_.master_busy, master.server.busy_us / end_us_);
    messages = std::max(messages, master.server.messages);
  }
  result_.most_messages = 1e6 * double(messages) / end_us_;
  for (const Server& compositor : compositors_)
    result_.compositor_busy = std::max(result_.compositor_busy, compositor.busy_us / end_us_);
  if (two_levels()) {
    result_.top_busy = top_.busy_us / end_us_;
    result_.top_messages = top_.messages;
  }
  return result_;
}

}  // namespace

SimulatedFrame simulate(const FrameWork& now, const FrameWork& before, const ClusterModel& model,
                        const ClusterShape& shape) {
  return Simulation(now, before, model, shape).run();
}

}  // namespace goldthread::bench
