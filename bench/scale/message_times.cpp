// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/message_times.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "bench/error/statistics.h"
#include "bench/scale/linear_fit.h"
#include "bench/scale/thread_time.h"
#include "common/base/result.h"
#include "common/transport/loopback.h"

namespace goldthread::bench {
namespace {

constexpr std::size_t kLeastBytes = 64;
constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kBurstBytes = std::size_t{4} << 20;
constexpr std::size_t kLeastBurst = 16, kMostBurst = 512;
constexpr int kBursts = 5, kQuickBursts = 3;
constexpr double kQuickest = 0.1;
constexpr int kReturns = 25, kQuickReturns = 9;
constexpr std::chrono::milliseconds kWait{5};
constexpr std::chrono::seconds kPatience{30};

/// What the answering rank is told, in the first bytes of a message. Messages of a burst follow
/// their order, and the answer to it is the receiver's processor time in µs.
enum class Order : std::uint8_t { kReturn, kBurst, kEnd };
struct Header {
  Order order = Order::kReturn;
  std::uint32_t count = 0;
};

Buffer message_of(std::size_t bytes, Header header = {}) {
  Buffer message(std::max(bytes, sizeof(Header)));
  std::memset(message.data(), 0, message.size());
  std::memcpy(message.data(), &header, sizeof(Header));
  return message;
}

Buffer next_message(Transport& transport) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    if (auto envelope = transport.receive()) return std::move(envelope->message);
    if (std::chrono::steady_clock::now() > end)
      throw FatalError({"bench", "the other rank of the message measurement is silent",
                        "start it with two ranks", ExitStatus::kClusterFailed});
    transport.wait(kWait);
  }
}

template <class Value>
Value value_in(const Buffer& message) {
  Value value{};
  if (message.size() >= sizeof(Value)) std::memcpy(&value, message.data(), sizeof(Value));
  return value;
}

/// Processor times of both sides for one message of a burst.
std::pair<double, double> burst(Transport& transport, Rank peer, std::size_t bytes) {
  const std::size_t count = std::clamp(kBurstBytes / bytes, kLeastBurst, kMostBurst);
  std::vector<Buffer> messages;
  for (std::size_t i = 0; i < count; ++i) messages.push_back(message_of(bytes));
  transport.send(peer, message_of(0, {Order::kBurst, static_cast<std::uint32_t>(count)}));
  const double us = thread_us_of([&] {
    for (Buffer& message : messages) transport.send(peer, std::move(message));
    transport.flush(std::chrono::duration_cast<std::chrono::milliseconds>(kPatience));
  });
  const double receive_us = value_in<double>(next_message(transport));
  return {us / double(count), receive_us / double(count)};
}

double there_and_back_us(Transport& transport, Rank peer, std::size_t bytes) {
  Buffer message = message_of(bytes);
  const auto begin = std::chrono::steady_clock::now();
  transport.send(peer, std::move(message));
  next_message(transport);
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}

}  // namespace

std::vector<MessageTime> time_messages(Transport& transport, Rank peer, bool quick) {
  std::vector<MessageTime> times;
  for (std::size_t bytes = kLeastBytes; bytes <= kMostBytes; bytes *= 4) {
    std::vector<double> send, receive, returns;
    burst(transport, peer, bytes);  // connections are made, memory is touched
    for (int i = 0; i < (quick ? kQuickBursts : kBursts); ++i) {
      const auto [sent, received] = burst(transport, peer, bytes);
      send.push_back(sent);
      receive.push_back(received);
    }
    for (int i = 0; i < (quick ? kQuickReturns : kReturns); ++i)
      returns.push_back(there_and_back_us(transport, peer, bytes));
    MessageTime time{double(bytes), median(send), median(receive), 0};
    // What other users of the cores add is not the link's: one of the quickest counts.
    const double quick_us = percentile(returns, kQuickest);
    time.transit_us = std::max(0.0, quick_us / 2 - time.send_us - time.receive_us);
    times.push_back(time);
  }
  transport.send(peer, message_of(0, {Order::kEnd, 0}));
  transport.flush(std::chrono::duration_cast<std::chrono::milliseconds>(kPatience));
  return times;
}

void answer_messages(Transport& transport) {
  const Rank asking{0};
  while (true) {
    Buffer message = next_message(transport);
    const auto header = value_in<Header>(message);
    if (header.order == Order::kEnd) return;
    if (header.order == Order::kReturn) {
      transport.send(asking, std::move(message));
      continue;
    }
    const double us = thread_us_of([&] {
      for (std::uint32_t i = 0; i < header.count; ++i) next_message(transport);
    });
    Buffer answer(sizeof(us));
    std::memcpy(answer.data(), &us, sizeof(us));
    transport.send(asking, std::move(answer));
  }
}

MeasuredLink time_loopback(bool quick) {
  const LoopbackNetwork network(2);
  const auto here = network.connect({0}), there = network.connect({1});
  std::jthread peer([&] { answer_messages(*there); });
  return {"threads of one process", time_messages(*here, {1}, quick)};
}

FittedLink fit_link(const MeasuredLink& link) {
  const auto fit = [&](double MessageTime::*member, double& residual) {
    std::vector<TimedTerms> terms;
    for (const MessageTime& time : link.times) terms.push_back({{1, time.bytes}, time.*member});
    const LinearFit found = fit_linear(terms);
    residual = found.worst;
    return Affine{found.first, found.second};
  };
  FittedLink fitted;
  fitted.costs.send = fit(&MessageTime::send_us, fitted.send_residual);
  fitted.costs.receive = fit(&MessageTime::receive_us, fitted.receive_residual);
  fitted.costs.transit = fit(&MessageTime::transit_us, fitted.transit_residual);
  return fitted;
}

}  // namespace goldthread::bench
