#pragma once
// Whole numbers that name one kind of thing each, so that two kinds can't be taken for each other.
#include <compare>
#include <cstddef>
#include <cstdint>

namespace rayfarm {

/// `Kind` is a type that is never defined.
template <typename Kind, typename Value = int>
class Index {
 public:
  constexpr Index() = default;
  constexpr explicit Index(Value value) : value_(value) {}
  constexpr Value value() const { return value_; }
  /// The place in an array that begins with the thing of number 0.
  constexpr size_t place() const { return static_cast<size_t>(value_); }
  constexpr Index& operator++() {
    ++value_;
    return *this;
  }
  constexpr auto operator<=>(const Index&) const = default;

 private:
  Value value_ = 0;
};

/// An end of the net: 0 is the host, nodes are numbered from 1, as ranks are.
using NodeId = Index<struct NodeKind>;
/// A frame as users number them.
using FrameNumber = Index<struct FrameNumberKind>;
/// A subpolygon in its grid, row by row.
using SubpolygonId = Index<struct SubpolygonKind>;
/// A step of a phase, from 0.
using StepIndex = Index<struct StepKind>;
/// A frame in the job's sequence, from 0: the step of the pictures' phase.
using FrameIndex = StepIndex;
/// An item of work in its phase, from 0, step by step.
using ItemIndex = Index<struct ItemKind, int64_t>;

}  // namespace rayfarm
