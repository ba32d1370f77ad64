// SPDX-License-Identifier: Apache-2.0
#pragma once
// A message of a direction to bytes and back: one byte for the kind, then its fields. A message
// whose last field is a Buffer is bulk: its header is padded to 16 bytes and put in front of the
// buffer, so that the payload is neither copied nor misaligned.

#include <optional>
#include <utility>

#include "common/protocol/codec.h"
#include "common/protocol/messages.h"

namespace goldthread {
namespace wire_detail {

constexpr std::size_t kBulkAlignment = 16;

template <class Message>
constexpr bool is_bulk() {
  using Fields = decltype(Message::fields());
  using Last = std::tuple_element_t<std::tuple_size_v<Fields> - 1, Fields>;
  return std::is_same_v<Last, Buffer Message::*>;
}

/// Applies `f` to each member in turn except a bulk message's Buffer; stops at false.
template <class Message, class F>
bool each_plain_field(Message& message, F f) {
  constexpr auto fields = std::remove_const_t<Message>::fields();
  constexpr std::size_t count =
      std::tuple_size_v<decltype(fields)> - (is_bulk<std::remove_const_t<Message>>() ? 1 : 0);
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (f(message.*std::get<I>(fields)) && ...);
  }
  (std::make_index_sequence<count>{});
}

template <class Message>
Buffer& payload_of(Message& message) {
  constexpr auto fields = Message::fields();
  return message.*std::get<std::tuple_size_v<decltype(fields)> - 1>(fields);
}

template <class Direction, std::size_t Kind>
std::optional<Direction> decode_kind(ByteReader& reader, Buffer& bytes) {
  using Message = std::variant_alternative_t<Kind, Direction>;
  Message message;
  if (!each_plain_field(message, [&](auto& field) { return reader.read(field); })) return {};
  if constexpr (is_bulk<Message>()) {
    if (!reader.skip_padding(kBulkAlignment)) return {};
    bytes.drop_front(reader.position());
    payload_of(message) = std::move(bytes);
  } else if (reader.left() != 0) {
    return {};
  }
  return Direction(std::in_place_index<Kind>, std::move(message));
}

}  // namespace wire_detail

/// The bytes of a message; takes over the payload of a bulk message.
template <class Direction>
Buffer encode(Direction message) {
  ByteWriter writer;
  writer.write(static_cast<std::uint8_t>(message.index()));
  return std::visit(
      [&](auto& value) {
        using Message = std::remove_reference_t<decltype(value)>;
        wire_detail::each_plain_field(value, [&](auto& field) {
          writer.write(field);
          return true;
        });
        Buffer bytes;
        if constexpr (wire_detail::is_bulk<Message>()) {
          writer.pad_to(wire_detail::kBulkAlignment);
          bytes = std::move(wire_detail::payload_of(value));
        }
        bytes.prepend(writer.bytes());
        return bytes;
      },
      message);
}

/// The message in `bytes`; nothing if they are short, long, or otherwise not one of this direction.
template <class Direction>
std::optional<Direction> decode(Buffer bytes) {
  ByteReader reader(bytes.bytes());
  std::uint8_t kind = 0;
  if (!reader.read(kind) || kind >= std::variant_size_v<Direction>) return {};
  return [&]<std::size_t... Kind>(std::index_sequence<Kind...>) {
    std::optional<Direction> message;
    static_cast<void>(
        ((Kind == kind &&
          (message = wire_detail::decode_kind<Direction, Kind>(reader, bytes), true)) ||
         ...));
    return message;
  }
  (std::make_index_sequence<std::variant_size_v<Direction>>{});
}

/// The name of a message, for counters and logs.
template <class Direction>
const char* message_name(const Direction& message) {
  return std::visit([](const auto& value) { return std::remove_cvref_t<decltype(value)>::kName; },
                    message);
}

}  // namespace goldthread
