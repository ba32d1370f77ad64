// SPDX-License-Identifier: Apache-2.0
#pragma once
// Listens on an address and answers HTTP; whoever presents the token goes on as a PageSocket. All
// handlers run on the thread of its io_context.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "compositor/gateway/gateway.h"
#include "compositor/gateway/http_rules.h"
#include "compositor/gateway/hub.h"

namespace goldthread {

class Server {
 public:
  /// Binds and listens. Throws FatalError that names --host or --port.
  Server(boost::asio::io_context& io, const GatewayOptions& options, Hub& hub);

  std::uint16_t port() const { return port_; }
  void start() { accept(); }
  void stop();

 private:
  void accept();
  void welcome(boost::asio::ip::tcp::socket socket);

  Hub& hub_;
  HttpPolicy policy_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer retry_;
  std::uint16_t port_ = 0;
};

}  // namespace goldthread
