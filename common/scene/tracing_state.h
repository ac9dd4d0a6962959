#pragma once
// What a process makes of a scene while it traces rays. The block is read-only, and other processes may read
// it at the same time: all this lies beside it.
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// A node of an octree that is made while rays are traced. Threads that read `state` see what it tells of.
struct GrownNode {
  enum class State : uint32_t {
    open,     ///< no ray has come into it yet
    divided,  ///< among its children
    cell      ///< it is one, and stays so
  };
  OctreeNode cube;    ///< its size and centre
  uint64_t name = 1;  ///< as a cell has
  std::atomic<State> state = State::open;
  std::vector<PrimitivePointer> primitives;  ///< that have a part in it; none of a divided one
  GrownNode* child = nullptr;                ///< the first of those that hold something
  GrownNode* sibling = nullptr;
  GrownNode* next = nullptr;  ///< of a cell: the next at its place in the hash table
};

/// An octree that is made while rays are traced (OctreeBuild::tracing).
struct GrownOctree {
  explicit GrownOctree(const Scene& scene, const Octree& octree);

  GrownNode* root;
  std::vector<std::atomic<GrownNode*>> table;  ///< the last cell made at each place; none: by pointers
  std::mutex mutex;  ///< held by the thread that divides a node; guards what follows
  std::deque<GrownNode> nodes;
  size_t primitive_count;  ///< of the whole
  size_t pointer_count;    ///< in the lists of all nodes
};

struct TracingState {
  explicit TracingState(const Scene& scene);

  /// No other of this process has had it: threads remember by it which scene their memories are of.
  uint64_t number;
  std::vector<std::unique_ptr<GrownOctree>> octrees;  ///< by octree; null where it was built before
};

/// Null where nothing is to be made. The scene's arrays have been checked.
std::shared_ptr<TracingState> make_tracing_state(const Scene& scene);

}  // namespace rayfarm
