#pragma once
// The nodes of a glTF file as objects of the scene: instances of meshes, skins, lights and cameras.
#include "common/description/formats/gltf/animation.h"
#include "common/description/formats/gltf/meshes.h"

namespace rayfarm {

/// A camera where it stands: its node, and those above it, from the scene down.
struct GltfPlacedCamera {
  uint32_t camera = 0;
  std::string name;
  std::vector<uint32_t> nodes;
};

class GltfNodes {
 public:
  /// All must outlive it. Throws InputError if the file's nodes are no tree.
  GltfNodes(const GltfFile& file, SceneDescription& scene, const GltfAnimation& animation,
            const Place& place);

  /// Adds all that the file's scene shows; returns the object that it is. Throws InputError.
  uint32_t add_all();
  const std::vector<GltfPlacedCamera>& cameras() const { return cameras_; }
  void add_notes();

 private:
  void check_tree() const;
  std::vector<uint32_t> roots() const;
  /// Parents stand before their children.
  void collect(const std::vector<uint32_t>& roots);
  void make_skeleton();
  /// Counts which meshes nodes need for themselves, and what of these is known before they are read.
  void count_copies();
  /// Of a mesh that was read for its first node: `more` others, before they are made.
  void take_copies(const GltfValue& node, std::span<const PrimitiveDescription> primitives,
                   size_t more) const;
  void add_content(uint32_t node);
  void add_mesh(uint32_t node, uint32_t mesh);
  void add_shared(uint32_t node, uint32_t mesh);
  /// How its mesh stands in a node, once for each copy.
  std::vector<std::vector<TransformStep>> copies_of(const GltfValue& node) const;
  void add_light(uint32_t node, const GltfValue& use);
  uint32_t object_of(uint32_t node);
  uint32_t add_object(std::string name);
  std::optional<std::vector<DeformationDescription::Joint>> joints_of(uint32_t skin);

  const GltfFile& file_;
  SceneDescription& scene_;
  const GltfAnimation& animation_;
  Place place_;
  GltfMaterials materials_;
  GltfMeshes meshes_;
  std::vector<uint32_t> parents_;  ///< of all nodes
  std::vector<uint32_t> order_;    ///< those that the scene shows
  std::vector<uint32_t> objects_;  ///< of the nodes that have one
  std::vector<uint32_t> bones_;    ///< of the skeleton, by node
  uint32_t skeleton_ = kNone;
  std::map<uint32_t, uint32_t> mesh_objects_;  ///< of meshes that nodes share
  struct Copies {
    size_t nodes = 0;
    bool is_read = false;
  };
  /// Of meshes that nodes have of their own, with and without a skin.
  std::map<std::pair<uint32_t, bool>, Copies> copies_;
  std::vector<GltfPlacedCamera> cameras_;
  uint32_t root_ = 0;
  size_t light_count_ = 0, ranges_ = 0, dark_lights_ = 0, strong_lights_ = 0, wide_cones_ = 0,
         hidden_skins_ = 0;
  size_t skinned_copies_ = 0, doubled_places_ = 0, idle_weights_ = 0;
  std::set<uint32_t> empty_skins_;
};

}  // namespace rayfarm
