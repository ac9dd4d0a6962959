#include "common/description/describe_part.h"

#include "common/description/part_file.h"
#include "common/errors/input_error.h"
#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

/// One file's contents on their way into a scene.
class Describer {
 public:
  Describer(SceneDescription& scene, const std::string& path, const Place& place)
      : scene_(scene), path_(path), place_(place) {}

  uint32_t describe(PartFile file) {
    s_ = file.scene;
    LibraryDescription library;
    library.path = path_;
    library.block = std::make_shared<const SceneBlock>(std::move(file.block));
    library.scene = s_;
    library.first_material = offsets_.materials = static_cast<uint32_t>(scene_.materials.size());
    library.first_texture = offsets_.textures = static_cast<uint32_t>(scene_.textures.size());
    library.first_diagram = offsets_.goniometric_diagrams = static_cast<uint32_t>(scene_.diagrams.size());
    library.root = first_object_ = static_cast<uint32_t>(scene_.objects.size());
    check();
    add_textures();
    add_diagrams();
    offsets_.principled = static_cast<uint32_t>(scene_.principled.size());
    for (PrincipledMaterial principled : s_.principled) {
      shift(principled, offsets_);
      scene_.principled.push_back(principled);
    }
    for (Material material : s_.materials) {
      shift(material, offsets_);
      static_cast<Material&>(scene_.materials.emplace_back(path_)) = material;
    }
    for (const SpectralColor& c : s_.spectral_colors)
      if (is_of_material(c.field))
        scene_.materials[offsets_.materials + c.index].spectra.push_back({c.field, 0, nodes_of(c)});
    add_objects();
    add_lights();
    scene_.libraries.push_back(std::move(library));
    return first_object_;
  }

 private:
  [[noreturn]] void damaged(const char* what) const {
    throw IoError(fmt::format("{}: is damaged: {}; compile it again with `rayfarm compile`", path_, what));
  }

  /// What hierarchies of this scene are built over must be numbers; indices were checked when the file was
  /// read.
  void check() const {
    if (s_.object_nodes.empty() || s_.object_nodes[0].step_count > 0 || s_.object_nodes[0].visible != kNone)
      damaged("its root");
    if (s_.object_nodes.size() > limits::kObjects - std::min(limits::kObjects, scene_.objects.size()))
      throw InputError(scene_.source(place_), "the scene has too many objects, those of part files counted");
    for (size_t i = 1; i < s_.object_nodes.size(); ++i)
      if (s_.object_nodes[i].parent == kNone) damaged("an object that belongs to none");
    for (const Part& part : s_.parts)
      if (!is_finite(part.collection.bounds.lo) || !is_finite(part.collection.bounds.hi) ||
          part.collection.bounds.is_empty() || part.collection.bounds.magnitude() > 2 * limits::kCoordinate)
        damaged("a part's bounds");
    for (const LuminaireTriangle& t : s_.luminaire_triangles)
      if (!(t.area_through > 0) || !std::isfinite(t.area_through)) damaged("a luminaire's area");
    for (const Vec4& value : s_.key_values)
      if (!is_finite(Vec3(value)) || !std::isfinite(value.w)) damaged("a key");
  }

  std::vector<SpectrumNode> nodes_of(const SpectralColor& c) const {
    const auto nodes = s_.spectrum_of(c);
    return {nodes.begin(), nodes.end()};
  }

  void add_textures() {
    uint64_t texels = s_.texels.size() / 3;
    for (const TextureDescription& t : scene_.textures) texels += t.texels.size() / 3;
    if (texels > limits::kTexels)
      throw IoError(
          fmt::format("{}: with its images the scene's have more than {} pixels", path_, limits::kTexels));
    for (const Texture& texture : s_.textures) {
      TextureDescription& description = scene_.textures.emplace_back();
      static_cast<Texture&>(description) = texture;
      description.name = path_;
      const size_t count = texel_count(texture);
      if (count == 0) continue;
      const auto own = s_.texels.subspan(3 * size_t{texture.first_texel}, 3 * count);
      description.texels.assign(own.begin(), own.end());
    }
  }

  void add_diagrams() {
    for (const GoniometricDiagram& diagram : s_.goniometric_diagrams) {
      DiagramDescription& description = scene_.diagrams.emplace_back();
      static_cast<GoniometricDiagram&>(description) = diagram;
      const auto own = s_.goniometric_values.subspan(
          diagram.first_value, values_of(diagram.vertical_count, diagram.horizontal_count));
      description.values.assign(own.begin(), own.end());
    }
  }

  Curve curve_of(uint32_t index) const {
    const CurveRecord& record = s_.curves[index];
    const auto frames = s_.key_frames.subspan(record.first_key, record.key_count);
    const auto values = s_.key_values.subspan(record.first_value, record.value_count());
    return {static_cast<Interpolation>(record.interpolation),
            {frames.begin(), frames.end()},
            {values.begin(), values.end()}};
  }

  void add_objects() {
    const auto library = static_cast<uint32_t>(scene_.libraries.size());
    for (uint32_t i = 0; i < s_.object_nodes.size(); ++i) {
      const ObjectNode& node = s_.object_nodes[i];
      scene_.objects.push_back({i == 0 ? path_ : fmt::format("object {}", i), {}, {}, place_});
      if (i == 0) continue;
      ChildDescription child;
      child.object = first_object_ + i;
      child.place = place_;
      for (const TransformStepRecord& step : s_.steps.subspan(node.first_step, node.step_count))
        child.transform.push_back(
            {static_cast<TransformKind>(step.kind), curve_of(step.curve), step.axis, step.matrix});
      if (node.visible != kNone) child.visible = curve_of(node.visible);
      scene_.objects[first_object_ + node.parent].children.push_back(std::move(child));
    }
    for (const Instance& instance : s_.instances) {
      std::optional<BuiltPart>& built = scene_.objects[first_object_ + instance.object_node].built;
      if (built) damaged("an object of two parts");
      built = {library, instance.part};
    }
  }

  void add_lights() {
    for (const ObjectLight& place : s_.object_lights) {
      Light light = s_.lights[place.light];
      if (light.kind >= LightKind::environment) damaged("an object's light");
      shift(light, offsets_);
      static_cast<LightPlace&>(light) = place.place;
      light.object_node = light.moving = kNone;
      if (!is_finite(light.position) || !is_finite(light.direction) || !is_finite(light.zero) ||
          !is_finite(light.color))
        damaged("an object's light");
      std::vector<SpectrumDescription> spectra;
      for (const SpectralColor& c : s_.spectral_colors)
        if (c.field == SpectralField::light && c.index == place.light)
          spectra.push_back({c.field, 0, nodes_of(c)});
      scene_.objects[first_object_ + place.object_node].lights.push_back({light, place_, std::move(spectra)});
    }
  }

  SceneDescription& scene_;
  std::string path_;
  Place place_;
  Scene s_;
  ArrayOffsets offsets_{};
  uint32_t first_object_ = 0;
};

}  // namespace

uint32_t add_part_file(SceneDescription& scene, const std::string& path, const Place& place,
                       const std::stop_token& stop) {
  return Describer(scene, path, place).describe(read_part_file(path, stop));
}

}  // namespace rayfarm
