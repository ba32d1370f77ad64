// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/page_socket.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

namespace goldthread {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {
constexpr auto kNever = std::chrono::steady_clock::time_point::max();
}  // namespace

PageSocket::PageSocket(beast::tcp_stream stream, Hub& hub, std::shared_ptr<void> admission)
    : stream_(std::move(stream)),
      hub_(hub),
      admission_(std::move(admission)),
      deadline_(stream_.get_executor()) {}

void PageSocket::configure() {
  stream_.next_layer().expires_never();  // the WebSocket has timers of its own
  stream_.set_option(
      websocket::stream_base::timeout{hub_.limits().handshake, hub_.limits().silent, true});
  websocket::permessage_deflate deflate;
  deflate.server_enable = false;  // pictures are compressed already
  stream_.set_option(deflate);
  stream_.read_message_max(page::kMaxMessageBytes);
  stream_.auto_fragment(false);
  beast::error_code ignored;
  stream_.next_layer().socket().set_option(asio::ip::tcp::no_delay(true), ignored);
}

void PageSocket::accept(Upgrade upgrade) {
  configure();
  auto request = std::make_shared<Upgrade>(std::move(upgrade));
  stream_.async_accept(*request, [self = shared_from_this(), request](ErrorCode error) {
    if (!error) self->begin();
  });
}

void PageSocket::begin() {
  viewer_ = hub_.join([this] { pull(); });
  drop_after(hub_.limits().handshake);
  read();
}

void PageSocket::read() {
  stream_.async_read(incoming_, [self = shared_from_this()](ErrorCode error, std::size_t) {
    self->on_read(error);
  });
}

void PageSocket::on_read(ErrorCode error) {
  if (error) {
    finish();
    return;
  }
  const bool nobody = !hub_.session().greeted(viewer_);
  if (stream_.got_text()) {
    const auto bytes = incoming_.data();
    hub_.session().receive_text(viewer_, {static_cast<const char*>(bytes.data()), bytes.size()});
  } else {
    hub_.session().receive_binary(viewer_);
  }
  incoming_.consume(incoming_.size());
  if (nobody && !writing_) deadline_.expires_at(kNever);
  hub_.settle();
  read();
}

void PageSocket::pull() {
  if (writing_ || closing_) return;
  std::optional<Frame> frame = hub_.session().next_frame(viewer_);
  if (!frame) return;
  writing_ = true;
  drop_after(hub_.limits().stalled);
  outgoing_ = std::move(*frame);
  std::visit([this](const auto& known) { write(known); }, outgoing_);
}

void PageSocket::write(const TextFrame& frame) {
  stream_.text(true);
  stream_.async_write(
      asio::buffer(*frame.text),
      [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_written(error); });
}

void PageSocket::write(const RegionFrame& frame) {
  stream_.binary(true);
  const std::array<asio::const_buffer, 2> parts{
      asio::buffer(frame.picture->headers[frame.region]),
      asio::buffer(frame.picture->picture.regions[frame.region].payload)};
  stream_.async_write(parts, [self = shared_from_this()](ErrorCode error, std::size_t) {
    self->on_written(error);
  });
}

void PageSocket::write(const CloseFrame& frame) {
  closing_ = true;
  drop_after(hub_.limits().handshake);
  const websocket::close_reason reason(static_cast<websocket::close_code>(frame.code),
                                       frame.reason);
  stream_.async_close(reason, [self = shared_from_this()](ErrorCode) { self->drop(); });
}

void PageSocket::on_written(ErrorCode error) {
  writing_ = false;
  deadline_.expires_at(kNever);
  outgoing_ = TextFrame{};
  if (error) {
    drop();
    return;
  }
  hub_.settle();
}

void PageSocket::drop_after(std::chrono::milliseconds time) {
  deadline_.expires_after(time);
  deadline_.async_wait([weak = weak_from_this()](ErrorCode error) {
    const auto self = weak.lock();
    // A later deadline may have been set when this handler was on its way already.
    const bool due = self && self->deadline_.expiry() <= std::chrono::steady_clock::now();
    if (!error && due) self->drop();
  });
}

// Pending reads and writes then fail, and the last of them lets go of this.
void PageSocket::drop() {
  ErrorCode ignored;
  stream_.next_layer().socket().close(ignored);
}

void PageSocket::finish() {
  if (viewer_ == 0) return;
  hub_.leave(std::exchange(viewer_, 0));
  hub_.settle();
}

}  // namespace goldthread
