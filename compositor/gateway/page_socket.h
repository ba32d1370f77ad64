// SPDX-License-Identifier: Apache-2.0
#pragma once
// One page's WebSocket: reads what it says into the session, writes the frames that the session has
// for it, one at a time, and ends it when it stalls. Lives as long as its pending operations.

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <memory>

#include "compositor/gateway/hub.h"

namespace goldthread {

class PageSocket : public std::enable_shared_from_this<PageSocket> {
 public:
  using Upgrade = boost::beast::http::request<boost::beast::http::empty_body>;

  /// `admission` counts the socket for as long as it is open.
  PageSocket(boost::beast::tcp_stream stream, Hub& hub, std::shared_ptr<void> admission);

  /// Answers the request to upgrade and goes on from there by itself.
  void accept(Upgrade upgrade);

 private:
  using ErrorCode = boost::beast::error_code;

  void configure();
  void begin();
  void read();
  void on_read(ErrorCode error);
  void pull();
  void write(const TextFrame& frame);
  void write(const RegionFrame& frame);
  void write(const CloseFrame& frame);
  void on_written(ErrorCode error);
  void drop_after(std::chrono::milliseconds time);
  void drop();
  void finish();

  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  Hub& hub_;
  std::shared_ptr<void> admission_;
  boost::asio::steady_timer deadline_;  ///< of the frame that is being written, or of `hello`
  boost::beast::flat_buffer incoming_;
  Frame outgoing_;  ///< lives while it is written
  Viewer viewer_ = 0;
  bool writing_ = false;
  bool closing_ = false;
};

}  // namespace goldthread
