#pragma once
// Octants about the centre of a volume's data (thesis 4.2.1.2): which primitives have a part in which.
#include "common/hierarchy/builder.h"

namespace rayfarm {

/// References on their way down a tree: those of one volume.
struct VolumeData {
  LargeVector<PrimitiveReference> references;
  int depth = 0;
  double growth = 1;  ///< how many references clipping has made of one, from the root to here

  Box box() const;
};

/// By octant; bits 1, 2, 4 for x, y, z above the centre.
using Octants = std::array<VolumeData, 8>;

/// Divides the volumes of one tree.
class OctantDivider {
 public:
  /// Volumes are not divided below this depth.
  static constexpr int kMostDepth = kMostHierarchyLevels - 2;
  /// Where all is clipped (ThesisClip::always): division ends before it would make more references of one,
  /// and where a volume is so small against the whole.
  static constexpr double kMostGrowth = 32, kLeastVolume = 1.0 / (1 << 16);

  /// `margin`: an octant reaches so far beyond the planes about the centre, too. `source` and `options` must
  /// outlive it.
  OctantDivider(const PrimitiveSource& source, const BuildOptions& options, const Box& whole, double margin);

  /// "The center of the data", or of the volume.
  Vec3 center_of(const VolumeData& volume) const;
  /// True if the volume holds more than a leaf may, and may still be divided.
  bool is_to_be_divided(const VolumeData& volume) const;
  /// Clips the references: each stands in all octants that its primitive has a part in. False: the volume is
  /// not to be divided so, and `octants` are empty.
  bool clip(const VolumeData& volume, const Vec3& center, Octants& octants) const;

 private:
  bool clips_always() const { return options_.thesis.clip == ThesisClip::always; }

  const PrimitiveSource& source_;
  const BuildOptions& options_;
  double margin_, least_extent_;
};

}  // namespace rayfarm
