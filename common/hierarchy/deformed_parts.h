#pragma once
// Parts that change their shape: what a frame makes of them. Every process computes that from the block, for
// each frame by itself. The tree of a part is refitted to its new shape, and built anew where refitting has
// made it bad; neither shows in a picture.
#include "common/hierarchy/builder.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// The places and normals of vertices, by vertex.
struct DeformedVertices {
  LargeVector<glm::vec3> positions, normals;
};

/// Where `frame` has the vertices: first each moves as the morph targets say, then with its joints (linear
/// blend skinning; Magnenat-Thalmann, Laperrière and Thalmann 1988). Normals are unit, as far as there are
/// some. Throws std::domain_error if a vertex has no finite place.
void deform(const Scene& scene, double frame, DeformedVertices& vertices);

/// The arrays that a frame has of its own, with the block's indices.
struct DeformedArrays {
  LargeVector<VolumeNode>& nodes;
  LargeVector<TriangleBlock>& triangle_blocks;
};

/// Builds a part over its triangles behind what is in the arrays. `shape` has triangle_count and
/// first_triangle, and gets the rest. Only options.progress and options.stop count: primitives stay whole, as
/// refitting asks for.
Part build_deformed_part(const Scene& scene, const DeformedVertices& vertices, const BuildOptions& options,
                         DeformingPart& shape, DeformedArrays arrays);

class DeformedParts {
 public:
  /// Without deforming parts it has nothing.
  explicit DeformedParts(const Scene& scene);
  DeformedParts(const DeformedParts&) = delete;
  DeformedParts& operator=(const DeformedParts&) = delete;

  /// The shapes at `frame`. Throws as `deform` does.
  void set(double frame);

  /// The scene for rays that are in such a part: its parts, nodes, blocks and normals begin with those of the
  /// frame, and end there.
  const Scene& shapes() const { return shapes_; }
  size_t builds() const { return builds_; }  ///< how often some parts were built anew

 private:
  void place_triangles();
  void refit();
  void rebuild(const std::vector<char>& is_bad);

  Scene scene_, shapes_;
  DeformedVertices vertices_;  ///< positions only while they are needed
  LargeVector<Part> parts_;
  LargeVector<VolumeNode> nodes_;
  LargeVector<TriangleBlock> triangle_blocks_;
  std::vector<DeformingPart> trees_;
  size_t builds_ = 0;
};

/// What a process holds for each moment of a frame, in bytes, if no part is built anew.
size_t deformed_bytes(const Scene& scene);

}  // namespace rayfarm
