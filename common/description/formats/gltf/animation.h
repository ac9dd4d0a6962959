#pragma once
// A clip of a glTF file as curves of its nodes.
#include <unordered_map>

#include "common/description/formats/gltf/file.h"
#include "common/description/scene_description.h"

namespace rayfarm {

/// What of a node changes.
struct GltfMotion {
  std::optional<Curve> translation, rotation, scale;
  std::vector<Curve> weights;  ///< of morph targets
};

class GltfAnimation {
 public:
  /// The clip that the file's options name, or its first. Where there is none of that name nothing moves, and
  /// the scene's ClipSearch knows. Throws InputError if it is damaged.
  GltfAnimation(const GltfFile& file, SceneDescription& scene);

  const GltfMotion* find(uint32_t node) const;
  /// From the first frame to the clip's last; none if the file has no clip.
  std::optional<std::array<int, 2>> frames() const { return frames_; }

  /// How a node stands in the one that it is in.
  std::vector<TransformStep> transform_of(uint32_t node) const;
  /// The weights of a node's morph targets, `count` of them.
  std::vector<Curve> weights_of(uint32_t node, size_t count) const;

 private:
  void read(const GltfValue& clip, Notes& notes);
  void read_channel(const GltfValue& clip, const GltfValue& channel, Notes& notes);
  std::vector<double> read_times(const GltfValue& sampler, std::vector<size_t>& kept, Notes& notes);
  size_t morph_targets_of(uint32_t node) const;

  const GltfFile& file_;
  std::unordered_map<uint32_t, GltfMotion> motions_;
  std::optional<std::array<int, 2>> frames_;
  double last_frame_ = 0;
};

/// The last frame of a clip whose last key is at `frame`, which may lie between two.
int last_frame_of(double frame);
/// With a millionth in place of 0, of which nothing could be turned back into the object's space.
Vec4 nonzero_scale(Vec4 scale);
/// Its direction; no rotation if it has none.
Vec4 unit_quaternion(const Vec4& q);

}  // namespace rayfarm
