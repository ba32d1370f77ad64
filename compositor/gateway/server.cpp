// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/server.h"

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <string>
#include <utility>

#include "compositor/gateway/page_socket.h"

namespace goldthread {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr std::uint32_t kMaxHeaderBytes = 16 * 1024;
constexpr std::chrono::milliseconds kAcceptRetry{100};
constexpr std::chrono::milliseconds kLinger{2000};

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

// One HTTP connection: reads a header, answers, reads the next.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(tcp::socket socket, Hub& hub, const HttpPolicy& policy,
                 std::shared_ptr<void> admission)
      : stream_(std::move(socket)), hub_(hub), policy_(policy), admission_(std::move(admission)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    stream_.expires_after(hub_.limits().handshake);
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](error_code error, std::size_t) { self->on_header(error); });
  }

 private:
  void on_header(error_code error) {
    if (error == http::error::end_of_stream) return;
    if (error && error.category() == http::make_error_code(http::error::bad_method).category()) {
      write({.status = 400,
             .fields = {{"Content-Type", "text/plain; charset=utf-8"}},
             .page = {},
             .text = "This is not HTTP.\n"},
            false);
      return;
    }
    if (error) return;
    std::optional<HttpReply> reply = answer(request(), policy_);
    if (reply) {
      write(std::move(*reply), parser_->is_done() && parser_->get().keep_alive());
      return;
    }
    std::make_shared<PageSocket>(std::move(stream_), hub_, std::move(admission_))
        ->accept(parser_->release());
  }

  HttpRequest request() const {
    const auto& message = parser_->get();
    HttpRequest request;
    request.method = view(message.method_string());
    request.target = view(message.target());
    request.if_none_match = view(message[http::field::if_none_match]);
    request.has_body = !parser_->is_done();
    request.websocket_upgrade = beast::websocket::is_upgrade(message);
    for (const auto& field : message) {
      if (field.name() == http::field::host) request.hosts.push_back(view(field.value()));
      if (field.name() == http::field::origin) request.origins.push_back(view(field.value()));
    }
    return request;
  }

  void write(HttpReply reply, bool keep_alive) {
    reply_ = std::move(reply);
    const std::span<const char> body =
        reply_.page.empty() ? std::span<const char>(reply_.text) : reply_.page;
    response_.emplace();
    response_->result(reply_.status);
    for (const auto& [name, value] : reply_.fields) response_->set(name, value);
    response_->keep_alive(keep_alive);
    const bool head = parser_->get().method() == http::verb::head;
    if (!head) response_->body() = {body.data(), body.size()};
    if (reply_.status != 304) response_->content_length(body.size());
    stream_.expires_after(hub_.limits().stalled);
    http::async_write(
        stream_, *response_,
        [self = shared_from_this()](error_code error, std::size_t) { self->on_written(error); });
  }

  void on_written(error_code error) {
    if (error) return;
    if (response_->keep_alive()) {
      read();
    } else {
      stream_.socket().shutdown(tcp::socket::shutdown_send, error);
      buffer_.clear();
      stream_.expires_after(kLinger);
      drain();
    }
  }

  // Closing with bytes unread would reset the connection and take the answer with it.
  void drain() {
    stream_.async_read_some(buffer_.prepare(kMaxHeaderBytes),
                            [self = shared_from_this()](error_code error, std::size_t) {
                              if (!error) self->drain();
                            });
  }

  beast::tcp_stream stream_;
  Hub& hub_;
  const HttpPolicy& policy_;
  std::shared_ptr<void> admission_;
  beast::flat_buffer buffer_{kMaxHeaderBytes};
  std::optional<http::request_parser<http::empty_body>> parser_;
  HttpReply reply_;
  std::optional<http::response<http::span_body<const char>>> response_;
};

[[noreturn]] void fail(std::string where, std::string what, std::string mend) {
  throw FatalError(
      {std::move(where), std::move(what), std::move(mend), ExitStatus::kClusterFailed});
}

[[noreturn]] void fail_to_bind(const GatewayOptions& options, error_code error) {
  const std::string port = "--port " + std::to_string(options.port);
  if (error == asio::error::address_in_use) {
    fail(port, "address already in use",
         "choose another with --port, or --port 0 for any free one");
  }
  if (error == asio::error::access_denied) {
    fail(port, "permission denied", "choose one above 1023 with --port");
  }
  fail("--host " + options.host, error.message(), "choose an address of this machine with --host");
}

tcp::resolver::results_type resolve(asio::io_context& io, const GatewayOptions& options) {
  error_code error;
  auto found =
      tcp::resolver(io).resolve(options.host, std::to_string(options.port),
                                tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error) {
    fail("--host " + options.host, "no such host (" + error.message() + ")",
         "choose an address of this machine with --host");
  }
  return found;
}

}  // namespace

Server::Server(asio::io_context& io, const GatewayOptions& options, Hub& hub)
    : hub_(hub), acceptor_(io), retry_(io) {
  error_code error;
  for (const auto& candidate : resolve(io, options)) {
    const tcp::endpoint endpoint = candidate.endpoint();
    acceptor_ = tcp::acceptor(io);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) break;
  }
  if (error) fail_to_bind(options, error);
  const tcp::endpoint bound = acceptor_.local_endpoint();
  port_ = bound.port();
  policy_ = {bound.address().is_loopback(), options.host, options.token};
}

void Server::stop() {
  error_code ignored;
  acceptor_.close(ignored);
  retry_.cancel();
}

void Server::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (!acceptor_.is_open()) return;
    if (!error) {
      welcome(std::move(socket));
      accept();
      return;
    }
    // Out of file descriptors, most likely: some will come back.
    retry_.expires_after(kAcceptRetry);
    retry_.async_wait([this](error_code cancelled) {
      if (!cancelled) accept();
    });
  });
}

void Server::welcome(tcp::socket socket) {
  std::shared_ptr<void> admission = hub_.admit();
  if (!admission) {
    static constexpr std::string_view kFull =
        "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 22\r\n\r\n"
        "Too many connections.\n";
    error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(kFull), ignored);
    return;
  }
  std::make_shared<HttpConnection>(std::move(socket), hub_, policy_, std::move(admission))->read();
}

}  // namespace goldthread
