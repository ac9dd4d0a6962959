#include "protocol/phase_data.h"

#include <algorithm>

namespace rayfarm {

DataFeed::DataFeed(Transport& transport, uint64_t address, Bytes data)
    : transport_(transport),
      address_(address),
      data_(std::move(data)),
      sent_(static_cast<size_t>(transport.node_count()) + 1),
      chunks_((data_.size() + kChunkBytes - 1) / kChunkBytes) {
  if (!data_.empty())
    for (NodeId node(1); node.value() <= transport.node_count(); ++node) lacking_.push_back(node);
}

std::shared_ptr<const Bytes> DataFeed::chunk(size_t offset) {
  std::weak_ptr<const Bytes>& known = chunks_[offset / kChunkBytes];
  if (auto shared = known.lock()) return shared;
  const size_t length = std::min(kChunkBytes, data_.size() - offset);
  // The last word is filled up.
  Bytes payload((length + kDataWordBytes - 1) / kDataWordBytes * kDataWordBytes), message;
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(offset), length, payload.begin());
  encode_load_data({address_ + offset, payload}, message);
  const auto made = std::make_shared<const Bytes>(std::move(message));
  known = made;
  return made;
}

bool DataFeed::feed(NodeId node) {
  size_t& sent = sent_[node.place()];
  if (sent == data_.size() || transport_.unsent_bytes(node) + kChunkBytes > kMostUnsentBytes) return false;
  transport_.send_of_broadcast(node, Channel::command, chunk(sent), sent == furthest_);
  sent = std::min(sent + kChunkBytes, data_.size());
  furthest_ = std::max(furthest_, sent);
  return true;
}

bool DataFeed::turn() {
  // A bounded number of nodes a turn: results come in meanwhile.
  constexpr size_t kMost = 256;
  bool has_fed = false;
  for (size_t i = std::min(kMost, lacking_.size()); i > 0; --i) {
    if (next_ >= lacking_.size()) next_ = 0;
    const NodeId node = lacking_[next_];
    while (feed(node)) has_fed = true;
    if (sent_[node.place()] < data_.size()) {
      ++next_;
    } else {
      lacking_[next_] = lacking_.back();
      lacking_.pop_back();
    }
  }
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
