#include "common/description/formats/mtl_material.h"

#include <filesystem>

#include "common/description/scene_images.h"
#include "common/materials/principled.h"
#include "common/math/portable_math.h"
#include "common/textures/normal_map.h"

namespace rayfarm {
namespace {

using Encoding = ImageReading::Encoding;

double mean_of(const glm::vec3& c) {
  return static_cast<double>(c.x + c.y + c.z) / 3;
}
double number_or(const std::optional<float>& number, double otherwise) {
  return number ? static_cast<double>(*number) : otherwise;
}

/// What `illum` asks for.
bool is_matt(int illum) {
  return illum == 0 || illum == 1;
}
bool is_glass(int illum) {
  return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}
bool is_refracting(int illum) {
  return illum == 6 || illum == 7;
}
bool is_mirroring(int illum) {
  return illum >= 3 && illum <= 9;
}

/// The roughness whose facets lean as those of a highlight cosⁿ of the half-way vector: alpha² is 2 / (n + 2)
/// (Walter et al. 2007), and alpha the square of the roughness.
double roughness_of(double shininess) {
  return portable_pow(2 / (shininess + 2), 0.25);
}

class MaterialMaker {
 public:
  MaterialMaker(SceneDescription& scene, const std::string& library, const MtlMaterial& written,
                const std::stop_token& stop)
      : scene_(scene),
        library_(library),
        w_(written),
        stop_(stop),
        m_(written.name),
        p_(usual_principled()) {}

  MaterialDescription make() {
    illum_ = w_.illumination.value_or(2);
    if (illum_ < 0 || illum_ > 9)
      note(fmt::format("`illum` {} of material '{}' is not used: it is shaded as by `illum` 2", illum_,
                       w_.name));
    read_opacity();
    read_colors();
    set_coefficients();
    if (is_plain()) {
      if (w_.diffuse_map) m_.texture = texture(*w_.diffuse_map, {});
    } else {
      make_principled();
    }
    return std::move(m_);
  }

 private:
  void note(std::string_view text) { scene_.notes.add(w_.place, text); }

  bool has_physical_keys() const {
    return w_.roughness || w_.metallic || w_.coat || w_.roughness_map || w_.metallic_map || w_.coat_map;
  }
  bool passes_light() const { return is_glass(illum_) && opacity_ < 1; }

  /// True of what is diffuse and maybe shines, with no map but one in its usual place: the classical models
  /// and paths see the same in it.
  bool is_plain() const {
    const auto is_usual = [](const std::optional<MtlMap>& map) {
      return !map ||
             (map->offset == Vec2(0) && map->scale == Vec2(1) && !map->is_clamped && map->channel == 0);
    };
    return !has_physical_keys() && specular_ == glm::vec3(0) && opacity_ == 1 && is_usual(w_.diffuse_map) &&
           !w_.specular_map && !w_.emission_map && !w_.opacity_map && !w_.bump_map && !w_.normal_map;
  }

  void read_opacity() {
    opacity_ = number_or(w_.opacity, 1 - number_or(w_.transparency, 0));
    // Which of the two counts where they contradict each other is not said anywhere; most read `d`.
    if (w_.opacity && w_.transparency && std::abs(*w_.opacity + *w_.transparency - 1) > 1e-3f)
      note(fmt::format("`Tr` {:g} of material '{}' is not used: `d` says {:g}", *w_.transparency, w_.name,
                       *w_.opacity));
    opacity_ = std::clamp(opacity_, 0.0, 1.0);
    if (opacity_ == 0 && !is_glass(illum_) && !w_.opacity_map)
      note(fmt::format("material '{}' is not seen: its `{}` says that nothing of it is there", w_.name,
                       w_.opacity ? "d" : "Tr"));
  }

  /// A map is weighed by its colour; exporters that write 0 there, or nothing, mean the map.
  static glm::vec3 color_of(const std::optional<glm::vec3>& color, const std::optional<MtlMap>& map) {
    if (map && (!color || *color == glm::vec3(0))) return glm::vec3(1);
    return color.value_or(glm::vec3(0));
  }
  static double number_of(const std::optional<float>& number, const std::optional<MtlMap>& map,
                          double otherwise) {
    if (map && (!number || *number == 0)) return 1;
    return std::clamp(number_or(number, otherwise), 0.0, 1.0);
  }

  void read_colors() {
    diffuse_ = color_of(w_.diffuse, w_.diffuse_map);
    emission_ = color_of(w_.emission, w_.emission_map);
    specular_ = color_of(w_.specular, w_.specular_map);
    if (!w_.diffuse && !w_.diffuse_map && emission_ == glm::vec3(0))
      note(fmt::format("material '{}' has no `Kd`: it is black", w_.name));
    if (is_matt(illum_) && !has_physical_keys()) {
      if (specular_ != glm::vec3(0))
        note(fmt::format("`Ks` of material '{}' is not used: `illum` {} has no highlights", w_.name, illum_));
      specular_ = glm::vec3(0);
    }
  }

  /// Of the classical models: MTL's own terms, but ambient light takes a fifth of `Kd`.
  void set_coefficients() {
    const double kept = is_glass(illum_) ? opacity_ : 1;
    m_.color = Color(diffuse_);
    m_.ambient = 0.2 * kept;
    m_.diffuse = kept;
    m_.specular = std::min(1.0, mean_of(specular_));
    m_.shininess = number_or(w_.shininess, 1);
    m_.reflect = is_mirroring(illum_) ? m_.specular : 0;
    m_.back = Color(m_.reflect);
    m_.transmit = is_glass(illum_) ? 1 - opacity_ : 0;
    if (emission_ == glm::vec3(0)) return;
    m_.emission = Color(emission_);
    if (!is_plain()) return;
    m_.kind = MaterialKind::luminaire;
    m_.ambient = 0;
  }

  double index() const {
    return w_.index && *w_.index >= 1 && *w_.index <= 100 ? static_cast<double>(*w_.index) : 1;
  }

  void make_principled() {
    p_.ior = index() > 1 ? index() : 1.5;
    map_color(PrincipledInput::base_color, w_.diffuse_map, Color(1));
    map_color(PrincipledInput::emission, w_.emission_map, Color(1));
    set_reflection();
    set_transmission();
    set_scalar(PrincipledInput::opacity, is_glass(illum_) ? 1 : opacity_, w_.opacity_map);
    set_bumps();
    p_.has_coefficients = has_physical_keys() ? 0 : 1;
    if (w_.emission_map)
      note(
          fmt::format("'{}' shines but is no lamp, as its emission has a texture: rays find its light by "
                      "chance alone, in `path` and `thesis` with noise, in the other models not at all",
                      w_.name));
    if (w_.specular_map && p_.has_coefficients)
      note(
          fmt::format("`map_Ks` of material '{}' acts in `path` alone: other models take its `Ks`", w_.name));
    m_.principled = static_cast<uint32_t>(scene_.principled.size());
    finish_principled(p_, m_);
    scene_.principled.push_back(p_);
  }

  /// `Ks` 0.5 is what the index of refraction reflects, as in Blender; where `illum` asks for mirrors it is
  /// what they reflect, and they are sharp.
  void set_reflection() {
    const double r = (p_.ior - 1) / (p_.ior + 1);
    double per_specular = 2, roughness = w_.shininess ? roughness_of(number_or(w_.shininess, 0)) : 0.5;
    if (is_mirroring(illum_) && !has_physical_keys()) {
      roughness = 0;
      per_specular = 1 / (r * r);
    }
    const bool is_said = w_.specular || w_.specular_map;
    if (is_said && !passes_light()) {
      map_color(PrincipledInput::specular_color, w_.specular_map, per_specular * Color(specular_));
      if (specular_ == glm::vec3(0)) p_[PrincipledInput::specular].factor = Color(0);
    } else if (!is_said && !has_physical_keys() && !passes_light()) {
      p_[PrincipledInput::specular].factor = Color(0);
    }
    set_scalar(PrincipledInput::roughness, number_of(w_.roughness, w_.roughness_map, roughness),
               w_.roughness_map);
    set_scalar(PrincipledInput::metallic, number_of(w_.metallic, w_.metallic_map, 0), w_.metallic_map);
    set_scalar(PrincipledInput::clearcoat, number_of(w_.coat, w_.coat_map, 0), w_.coat_map);
    set_scalar(PrincipledInput::clearcoat_roughness, number_of(w_.coat_roughness, w_.coat_roughness_map, 0),
               w_.coat_roughness_map);
  }

  /// The colour of what passes is `Tf`: of a material that is both, it is between the two.
  void set_transmission() {
    if (!passes_light()) return;
    const double through = 1 - opacity_;
    p_[PrincipledInput::transmission].factor = Color(through);
    const Color filter = glm::min(Color(w_.filter.value_or(glm::vec3(1))), Color(1));
    m_.color = opacity_ * Color(diffuse_) + through * filter;
    m_.interior = filter;
    m_.is_solid = is_refracting(illum_) ? 1 : 0;
    if (m_.is_solid) m_.index = p_.ior;
  }

  void set_bumps() {
    PrincipledSource& normal = p_[PrincipledInput::normal];
    if (w_.normal_map) {
      use(normal, *w_.normal_map, texture(*w_.normal_map, {.encoding = Encoding::linear}));
      normal.factor = Color(w_.normal_map->bump);
      if (w_.bump_map)
        note(fmt::format("`map_Bump` of material '{}' is not used: it has a map of normals, too", w_.name));
    } else if (w_.bump_map) {
      use(normal, *w_.bump_map, texture(*w_.bump_map, {.encoding = Encoding::linear}, true));
      normal.factor = Color(w_.bump_map->bump);
    }
  }

  void map_color(PrincipledInput input, const std::optional<MtlMap>& map, const Color& factor) {
    p_[input].factor = factor;
    if (map) use(p_[input], *map, texture(*map, {}));
  }
  void set_scalar(PrincipledInput input, double factor, const std::optional<MtlMap>& map) {
    PrincipledSource& source = p_[input];
    source.factor = Color(factor);
    if (!map) return;
    source.channel = map->channel == 'r'   ? TextureChannel::red
                     : map->channel == 'g' ? TextureChannel::green
                     : map->channel == 'b' ? TextureChannel::blue
                                           : TextureChannel::luminance;
    const bool may_be_alpha = map->channel == 'm' || (map->channel == 0 && input == PrincipledInput::opacity);
    std::optional<uint32_t> id = may_be_alpha ? alpha_texture(*map) : std::nullopt;
    use(source, *map, id ? *id : texture(*map, {.encoding = Encoding::linear}));
  }
  static void use(PrincipledSource& source, const MtlMap& map, uint32_t texture) {
    source.texture = texture;
    source.u_row = {map.scale.x, 0, map.offset.x};
    source.v_row = {0, map.scale.y, map.offset.y};
  }

  /// The file beside the library; of one that was written elsewhere (`C:\textures\wood.png`) its last name.
  std::string path_of(const MtlMap& map) {
    const std::filesystem::path folder = std::filesystem::path(library_).parent_path(), file(map.file);
    const std::filesystem::path path = folder / file;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      if (const std::filesystem::path near = folder / file.filename();
          file.has_parent_path() && std::filesystem::exists(near, ignored)) {
        scene_.notes.add(map.place, fmt::format("{}: no such file; the one beside the library stands for it",
                                                path.lexically_normal().string()));
        return near.lexically_normal().string();
      }
    return path.lexically_normal().string();
  }

  /// An image that is read once, however many materials name it in the same way. `has_heights`: unless it
  /// holds normals, it is made a map of them.
  uint32_t texture(const MtlMap& map, const ImageReading& reading, bool has_heights = false) {
    TextureDescription image;
    const std::string path = path_of(map);
    std::error_code ignored;
    image.name = path;
    const std::string file = std::filesystem::weakly_canonical(path, ignored).string();
    if (has_heights)
      image.name += " (bumps)";
    else if (reading.part == ImagePart::alpha)
      image.name += " (alpha)";
    else if (reading.encoding == Encoding::linear)
      image.name += " (numbers)";
    if (map.is_clamped) {
      image.name += " (clamped)";
      image.wraps = {TextureWrap::clamp, TextureWrap::clamp};
    }
    // Others have names of their own, which may read the same.
    image.origin = (file.empty() ? path : file) + image.name.substr(path.size());
    const auto found = std::find_if(scene_.textures.begin(), scene_.textures.end(),
                                    [&](const TextureDescription& t) { return t.origin == image.origin; });
    if (found != scene_.textures.end()) return static_cast<uint32_t>(found - scene_.textures.begin());
    try {
      load_scene_image(scene_, path, image, stop_, reading);
    } catch (const IoError& e) {
      throw InputError(map.place, e.what());
    }
    if (has_heights && !holds_normals(image, image.texels)) make_normals_of_heights(image, image.texels);
    scene_.textures.push_back(std::move(image));
    return static_cast<uint32_t>(scene_.textures.size() - 1);
  }

  /// Nothing if the image has no alpha, or one that says nothing.
  std::optional<uint32_t> alpha_texture(const MtlMap& map) {
    const size_t before = scene_.textures.size();
    try {
      const uint32_t id = texture(map, {.part = ImagePart::alpha});
      const std::vector<uint16_t>& texels = scene_.textures[id].texels;
      if (map.channel == 'm' ||
          std::any_of(texels.begin(), texels.end(), [&](uint16_t t) { return t != texels.front(); }))
        return id;
    } catch (const InputError&) {  // of a file that can't be read at all the caller will hear
    }
    scene_.textures.resize(before);
    return std::nullopt;
  }

  SceneDescription& scene_;
  const std::string& library_;
  const MtlMaterial& w_;
  const std::stop_token& stop_;
  MaterialDescription m_;
  PrincipledMaterial p_;
  int illum_ = 2;
  double opacity_ = 1;
  glm::vec3 diffuse_{0}, specular_{0}, emission_{0};
};

}  // namespace

void add_mtl_material(SceneDescription& scene, const std::string& library, const MtlMaterial& material,
                      const std::stop_token& stop) {
  MaterialDescription made = MaterialMaker(scene, library, material, stop).make();
  scene.materials.push_back(std::move(made));
}

}  // namespace rayfarm
