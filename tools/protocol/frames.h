// SPDX-License-Identifier: Apache-2.0
template <class Variant, class Message>
Decoded<Variant> decode_as(std::span<const std::uint8_t> bytes) {
  Reader in(bytes);
  Message message;
  read(in, message);
  if (in.ok() && in.left() > 0) {
    in.fail("the frame", "has " + std::to_string(in.left()) + " bytes too many");
  }
  if (!in.ok()) return {std::nullopt, in.error()};
  return {Variant(std::move(message)), {}};
}

}  // namespace detail

/// Appends the frame of `message` to `out`; on an exception `out` is as it was.
template <class Message>
void encode(const Message& message, std::vector<std::uint8_t>& out) {
  const std::size_t before = out.size();
  try {
    out.push_back(static_cast<std::uint8_t>(Message::message_type));
    detail::Writer writer(out);
    detail::write(writer, message);
  } catch (...) {
    out.resize(before);
    throw;
  }
}

/// The frame of `message`.
template <class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  std::vector<std::uint8_t> out;
  encode(message, out);
  return out;
}

/// Appends the record of an entity to `out`; on an exception `out` is as it was.
template <class Entity>
void append_record(const Entity& entity, std::vector<std::uint8_t>& out) {
  const std::size_t before = out.size();
  try {
    detail::Writer writer(out);
    detail::write(writer, entity);
  } catch (...) {
    out.resize(before);
    throw;
  }
}

/// The entities of one kind whose records `bytes` are.
template <class Entity>
Decoded<std::vector<Entity>> decode_records(std::span<const std::uint8_t> bytes) {
  detail::Reader in(bytes);
  std::vector<Entity> entities;
  while (in.ok() && in.left() > 0) detail::read(in, entities.emplace_back());
  if (!in.ok()) return {std::nullopt, in.error()};
  return {std::move(entities), {}};
}
