#pragma once
// The data of a phase on their way from the host to all nodes: in chunks, each node as fast as it takes them,
// so that neither a large stage nor a node that is silent fills the host's memory with messages.
#include <vector>

#include "protocol/transport.h"

namespace rayfarm {

/// The host's end.
class DataFeed {
 public:
  /// Chunks on their way to a node.
  static constexpr size_t kMostUnsentBytes = 4 * kChunkBytes;

  DataFeed(Transport& transport, uint64_t address, Bytes data);
  /// Sends what nodes have room for. False: nobody had room, or all have all.
  bool turn();
  /// A node gets nothing more.
  void leave_out(NodeId node) { sent_[node.place()] = data_.size(); }
  const Bytes& data() const { return data_; }

 private:
  bool feed(NodeId node);
  Transport& transport_;
  uint64_t address_;
  Bytes data_;
  std::vector<size_t> sent_;  ///< by node: bytes
  size_t furthest_ = 0;       ///< bytes that some node was sent
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
