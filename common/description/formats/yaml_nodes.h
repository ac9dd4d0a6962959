#pragma once
// The object tree of the YAML format. scenes/README.md is the manual.
#include <map>
#include <tuple>

#include "common/description/formats/yaml_document.h"
#include "common/description/load_options.h"

namespace rayfarm {

/// Reads nodes of one document into objects of its scene.
class YamlNodes {
 public:
  YamlNodes(YamlDocument& document, const LoadOptions& options)
      : document_(document), scene_(document.scene()), options_(options) {}

  /// `objects`: a map of names to nodes or lists of them. A definition may use one that stands further down.
  void read_definitions(const YamlValue& value);
  /// A list of nodes that are in `object`.
  void read_children(const YamlValue& list, uint32_t object) { read_children(list, object, {}, 0); }

 private:
  /// What a node hands down to those in it.
  struct Inherited {
    uint32_t material = 0;
    uint32_t structure = kNone;
    float zone_size = 0;
  };

  uint32_t zoned(uint32_t material, float zone_size);
  void read_children(const YamlValue& list, uint32_t object, const Inherited& inherited, size_t depth);
  void read_node(const YamlValue& value, uint32_t object, Inherited inherited, size_t depth);
  void give_zone_size(PrimitiveDescription& primitive, float zone_size);
  uint32_t add_object(const std::string& name, const Place& place);
  void read_content(YamlMap& map, const YamlValue& value, uint32_t target, const Inherited& inherited,
                    const std::optional<YamlValue>& own_material, size_t depth);
  uint32_t find_object(const YamlValue& value) const;
  uint32_t read_part_file(const YamlValue& value);
  /// True if the node's material replaces those of its mesh's file; said there or in the mesh.
  static bool has_override(const std::optional<YamlValue>& of_node, YamlMap& mesh,
                           const Inherited& inherited);
  void read_mesh(const YamlValue& value, const std::optional<YamlValue>& replaces, uint32_t object,
                 const Inherited& inherited, const std::optional<YamlValue>& own_material);

  YamlDocument& document_;
  SceneDescription& scene_;
  const LoadOptions& options_;
};

}  // namespace rayfarm
