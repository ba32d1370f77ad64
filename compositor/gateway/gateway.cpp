// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/gateway.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <utility>

#include "compositor/gateway/hub.h"
#include "compositor/gateway/server.h"

namespace goldthread {

namespace asio = boost::asio;

namespace {

constexpr std::chrono::milliseconds kFarewell{500};

GatewayOptions checked(GatewayOptions options) {
  if (options.token.empty()) {
    throw FatalError(
        {"--token", "is empty", "give one, or none for a random one", ExitStatus::kUsage});
  }
  return options;
}

// Bugs of the caller are thrown where they are, not on the gateway's thread.
void check_message(const std::string& json) {
  const auto parsed = nlohmann::json::parse(json, nullptr, /*allow_exceptions=*/false);
  if (!parsed.is_object() || !parsed.contains("type") || !parsed["type"].is_string()) {
    throw std::invalid_argument("a message to a page is a JSON object with a type");
  }
}

}  // namespace

// The order of the members is the order of the ends: what pending handlers hold goes with the
// io_context, while the hub is still there to be told.
class Gateway::Impl {
 public:
  explicit Impl(const GatewayOptions& options)
      : hub_(options.limits, options.on_event),
        io_(1),
        server_(io_, options, hub_),
        farewell_(io_) {
    server_.start();
    thread_ = std::thread([this] { io_.run(); });
  }

  ~Impl() {
    asio::post(io_, [this] { say_farewell(); });
    thread_.join();
  }

  /// Runs `change(session)` on the gateway's thread.
  template <class Change>
  void post(Change change) {
    asio::post(io_, [this, change = std::move(change)]() mutable {
      change(hub_.session());
      hub_.settle();
    });
  }

  std::uint16_t port() const { return server_.port(); }
  std::vector<GatewayEvent> take_events() { return hub_.take_events(); }

 private:
  void say_farewell() {
    server_.stop();
    hub_.session().close_all(Session::kGoingAway, "the server ends");
    hub_.settle();
    farewell_.expires_after(kFarewell);
    farewell_.async_wait([this](auto) { io_.stop(); });
    hub_.when_empty([this] { io_.stop(); });
  }

  Hub hub_;
  asio::io_context io_;
  Server server_;
  asio::steady_timer farewell_;
  std::thread thread_;
};

Gateway::Gateway(GatewayOptions options)
    : impl_(std::make_unique<Impl>(checked(std::move(options)))) {}
Gateway::~Gateway() = default;

std::uint16_t Gateway::port() const { return impl_->port(); }

void Gateway::publish(Picture picture) {
  check_picture(picture);
  impl_->post([picture = std::move(picture)](Session& session) mutable {
    session.publish(std::move(picture));
  });
}

void Gateway::set_welcome(std::string welcome_json) {
  check_message(welcome_json);
  impl_->post([json = std::move(welcome_json)](Session& session) { session.set_welcome(json); });
}

void Gateway::broadcast(std::string state_json) {
  check_message(state_json);
  impl_->post([json = std::move(state_json)](Session& session) { session.broadcast(json); });
}

void Gateway::send(std::uint32_t viewer, std::string json) {
  check_message(json);
  impl_->post([viewer, json = std::move(json)](Session& session) mutable {
    session.send(viewer, std::move(json));
  });
}

std::vector<GatewayEvent> Gateway::take_events() { return impl_->take_events(); }

}  // namespace goldthread
