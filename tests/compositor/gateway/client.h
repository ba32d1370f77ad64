// SPDX-License-Identifier: Apache-2.0
#pragma once
// A page for the tests: a blocking WebSocket and plain bytes over TCP, each operation bounded in
// time. A time-out is a failure of the test, told by an exception.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compositor/gateway/gateway.h"
#include "compositor/gateway/region_codec.h"

namespace goldthread::testing_client {

inline constexpr std::chrono::seconds kPatience{20};

/// One message from the gateway, or the close of the connection.
struct Incoming {
  enum class Kind { kText, kRegion, kClosed } kind = Kind::kClosed;
  nlohmann::json json;
  std::vector<std::byte> bytes;
  RegionHeader header;
  std::uint16_t close_code = 0;  ///< 0: closed without a word
  std::string close_reason;
};

class Page {
 public:
  /// Connects and upgrades; throws boost::system::system_error if that fails.
  Page(std::uint16_t port, const std::string& target,
       const std::optional<std::string>& origin = std::nullopt);

  void send(const std::string& text);
  void send(const nlohmann::json& json) { send(json.dump()); }
  void send_binary(const std::string& bytes);
  /// Bytes that need not be a frame.
  void send_raw(const std::string& bytes);
  Incoming receive();
  /// The next text of this type; others before it are skipped, and so are regions.
  nlohmann::json expect(const std::string& type);
  /// The next whole picture: its regions in order.
  std::vector<Incoming> picture();
  /// Reads on until the connection ends.
  Incoming closed();
  void close();

 private:
  using Stream = boost::beast::websocket::stream<boost::beast::tcp_stream>;
  void run(const std::function<void(std::function<void(boost::system::error_code)>)>& start);

  std::unique_ptr<boost::asio::io_context> io_;  ///< elsewhere, so that a Page can be moved
  Stream stream_;
  boost::beast::flat_buffer buffer_;
};

/// Sends bytes and returns all that comes back until the server closes or says nothing for long
/// enough after a whole answer.
std::string exchange(std::uint16_t port, const std::string& request);

/// A request of one line and its fields, with the right host, that ends the connection.
std::string request(const std::string& method, const std::string& target, std::uint16_t port,
                    const std::string& more = "");

unsigned status_of(const std::string& response);

/// Takes events until `enough` says so of all that came; fails the test when time is up.
std::vector<GatewayEvent> events_until(
    Gateway& gateway, const std::function<bool(const std::vector<GatewayEvent>&)>& enough);

/// Does any of the events match?
template <class T, class Condition>
std::function<bool(const std::vector<GatewayEvent>&)> some(Condition condition) {
  return [condition](const std::vector<GatewayEvent>& events) {
    for (const GatewayEvent& event : events) {
      const auto* known = std::get_if<T>(&event);
      if (known && condition(*known)) return true;
    }
    return false;
  };
}

}  // namespace goldthread::testing_client
