#include "protocol/phase_data.h"

#include <algorithm>

namespace rayfarm {

DataFeed::DataFeed(Transport& transport, uint64_t address, Bytes data)
    : transport_(transport),
      address_(address),
      data_(std::move(data)),
      sent_(static_cast<size_t>(transport.node_count()) + 1) {}

bool DataFeed::feed(NodeId node) {
  size_t& sent = sent_[node.place()];
  if (sent == data_.size() || transport_.unsent_bytes(node) + kChunkBytes > kMostUnsentBytes) return false;
  const size_t length = std::min(kChunkBytes, data_.size() - sent);
  // The last word is filled up.
  Bytes payload((length + kDataWordBytes - 1) / kDataWordBytes * kDataWordBytes), message;
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(sent), length, payload.begin());
  encode_load_data({address_ + sent, payload}, message);
  transport_.send_of_broadcast(node, Channel::command, std::move(message), sent == furthest_);
  sent += length;
  furthest_ = std::max(furthest_, sent);
  return true;
}

bool DataFeed::turn() {
  bool has_fed = false;
  for (NodeId node(1); node.value() <= transport_.node_count(); ++node)
    while (feed(node)) has_fed = true;
  return has_fed;
}

void DataIntake::expect(uint64_t address, uint64_t bytes) {
  address_ = address;
  come_ = 0;
  bytes_ = Bytes(bytes);
}

void DataIntake::take(const LoadData& chunk) {
  const size_t left = bytes_.size() - come_;
  const bool is_next = chunk.address == address_ + come_ && left > 0 && !chunk.payload.empty();
  // Only the last chunk may be filled up, and by less than a word.
  if (!is_next || (chunk.payload.size() > left && chunk.payload.size() - left >= kDataWordBytes))
    throw ProtocolError("data came that were not expected");
  const size_t length = std::min(left, chunk.payload.size());
  std::copy_n(chunk.payload.begin(), length, bytes_.begin() + static_cast<std::ptrdiff_t>(come_));
  come_ += length;
}

}  // namespace rayfarm
