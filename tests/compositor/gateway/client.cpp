// SPDX-License-Identifier: Apache-2.0
#include "client.h"

#include <gtest/gtest.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <stdexcept>
#include <thread>

namespace goldthread::testing_client {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;
using tcp = asio::ip::tcp;

namespace {

tcp::endpoint local(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

}  // namespace

Page::Page(std::uint16_t port, const std::string& target, const std::optional<std::string>& origin)
    : io_(std::make_unique<asio::io_context>()), stream_(*io_) {
  beast::get_lowest_layer(stream_).connect(local(port));
  stream_.read_message_max(256 << 20);
  stream_.set_option(websocket::stream_base::decorator([origin](websocket::request_type& request) {
    if (origin) request.set(beast::http::field::origin, *origin);
  }));
  const std::string host = "127.0.0.1:" + std::to_string(port);
  run([&](auto done) { stream_.async_handshake(host, target, done); });
}

void Page::run(const std::function<void(std::function<void(error_code)>)>& start) {
  std::optional<error_code> result;
  start([&](error_code error) { result = error; });
  io_->restart();
  io_->run_for(kPatience);
  if (!result) {
    beast::get_lowest_layer(stream_).cancel();
    io_->run();
    throw std::runtime_error("the gateway took too long");
  }
  if (*result) throw boost::system::system_error(*result);
}

void Page::send(const std::string& text) {
  stream_.text(true);
  run([&](auto done) {
    stream_.async_write(asio::buffer(text), [done](error_code error, std::size_t) { done(error); });
  });
}

void Page::send_binary(const std::string& bytes) {
  stream_.binary(true);
  run([&](auto done) {
    stream_.async_write(asio::buffer(bytes),
                        [done](error_code error, std::size_t) { done(error); });
  });
}

void Page::send_raw(const std::string& bytes) {
  run([&](auto done) {
    asio::async_write(stream_.next_layer(), asio::buffer(bytes),
                      [done](error_code error, std::size_t) { done(error); });
  });
}

Incoming Page::receive() {
  buffer_.clear();
  Incoming incoming;
  try {
    run([&](auto done) {
      stream_.async_read(buffer_, [done](error_code error, std::size_t) { done(error); });
    });
  } catch (const boost::system::system_error&) {
    incoming.close_code = stream_.reason().code;
    incoming.close_reason = stream_.reason().reason.c_str();
    return incoming;
  }
  const auto* data = static_cast<const char*>(buffer_.data().data());
  const std::string bytes(data, buffer_.size());
  if (stream_.got_text()) {
    incoming.kind = Incoming::Kind::kText;
    incoming.json = nlohmann::json::parse(bytes);
    return incoming;
  }
  incoming.kind = Incoming::Kind::kRegion;
  for (const char c : bytes) incoming.bytes.push_back(static_cast<std::byte>(c));
  incoming.header = value_or_throw(decode_region_header(incoming.bytes));
  return incoming;
}

nlohmann::json Page::expect(const std::string& type) {
  for (;;) {
    Incoming incoming = receive();
    if (incoming.kind == Incoming::Kind::kClosed) {
      throw std::runtime_error("closed while waiting for " + type + ": " + incoming.close_reason);
    }
    if (incoming.kind == Incoming::Kind::kText && incoming.json.at("type") == type) {
      return incoming.json;
    }
  }
}

std::vector<Incoming> Page::picture() {
  std::vector<Incoming> regions;
  do {
    Incoming incoming = receive();
    if (incoming.kind == Incoming::Kind::kClosed) throw std::runtime_error("closed in a picture");
    if (incoming.kind == Incoming::Kind::kRegion) regions.push_back(std::move(incoming));
  } while (regions.empty() || regions.size() < regions[0].header.count);
  return regions;
}

Incoming Page::closed() {
  for (;;) {
    Incoming incoming = receive();
    if (incoming.kind == Incoming::Kind::kClosed) return incoming;
  }
}

void Page::close() {
  run([&](auto done) { stream_.async_close(websocket::close_code::normal, done); });
}

std::string exchange(std::uint16_t port, const std::string& request) {
  asio::io_context io;
  beast::tcp_stream stream(io);
  stream.connect(local(port));
  error_code error;
  asio::write(stream.socket(), asio::buffer(request), error);
  std::string response;
  std::array<char, 65536> piece{};
  // As beast::tcp_stream's time-outs need asynchronous calls, so does this.
  while (!error) {
    stream.expires_after(kPatience);
    stream.async_read_some(asio::buffer(piece), [&](error_code ended, std::size_t bytes) {
      response.append(piece.data(), bytes);
      error = ended;
    });
    io.restart();
    io.run();
  }
  if (error == beast::error::timeout) throw std::runtime_error("the gateway took too long");
  return response;
}

std::string request(const std::string& method, const std::string& target, std::uint16_t port,
                    const std::string& more) {
  return method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nConnection: close\r\n" + more + "\r\n";
}

unsigned status_of(const std::string& response) {
  constexpr std::size_t kCode = 9;  // after "HTTP/1.1 "
  return response.size() < kCode + 3 ? 0U
                                     : static_cast<unsigned>(std::stoul(response.substr(kCode, 3)));
}

std::vector<GatewayEvent> events_until(
    Gateway& gateway, const std::function<bool(const std::vector<GatewayEvent>&)>& enough) {
  std::vector<GatewayEvent> all;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!enough(all)) {
    if (std::chrono::steady_clock::now() > end) {
      ADD_FAILURE() << "the events did not come in time";
      break;
    }
    for (GatewayEvent& event : gateway.take_events()) all.push_back(std::move(event));
    std::this_thread::yield();
  }
  return all;
}

}  // namespace goldthread::testing_client
