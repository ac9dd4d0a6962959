#pragma once
// The data of a phase on their way from the host to all nodes: in chunks, each node as fast as it takes them,
// so that neither a large stage nor a node that is silent fills the host's memory with messages.
#include <memory>
#include <vector>

#include "protocol/transport.h"

namespace rayfarm {

/// The host's end.
class DataFeed {
 public:
  /// Chunks on their way to a node.
  static constexpr size_t kMostUnsentBytes = 4 * kChunkBytes;

  DataFeed(Transport& transport, uint64_t address, Bytes data);
  /// Sends what the next nodes have room for. False: none of these had room, or all have all.
  bool turn();
  /// A node gets nothing more.
  void leave_out(NodeId node) { sent_[node.place()] = data_.size(); }
  const Bytes& data() const { return data_; }

 private:
  bool feed(NodeId node);
  /// The message that begins at `offset` of the data. Nodes that are as far share it while it is on its way.
  std::shared_ptr<const Bytes> chunk(size_t offset);
  Transport& transport_;
  uint64_t address_;
  Bytes data_;
  std::vector<size_t> sent_;     ///< by node: bytes
  std::vector<NodeId> lacking_;  ///< nodes that were not sent all
  size_t next_ = 0;              ///< of these, whose turn it is
  std::vector<std::weak_ptr<const Bytes>> chunks_;
  size_t furthest_ = 0;  ///< bytes that some node was sent
};

/// A node's end.
class DataIntake {
 public:
  /// So many bytes will come; what came before is forgotten.
  void expect(uint64_t address, uint64_t bytes);
  /// Throws ProtocolError if the chunk is not the next.
  void take(const LoadData& chunk);
  bool is_whole() const { return come_ == bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  uint64_t address_ = 0;
  size_t come_ = 0;
  Bytes bytes_;
};

}  // namespace rayfarm
