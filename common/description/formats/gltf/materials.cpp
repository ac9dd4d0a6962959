#include "common/description/formats/gltf/materials.h"

#include <fmt/core.h>

#include "common/description/scene_images.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

TextureWrap wrap_of(const GltfValue& sampler, const char* key) {
  switch (sampler.whole_number(key, 10497)) {
    case 33071:
      return TextureWrap::clamp;
    case 33648:
      return TextureWrap::mirror;
    case 10497:
      return TextureWrap::repeat;
    default:
      sampler.at(key).fail("10497 (repeat), 33071 (clamp) or 33648 (mirror) was expected");
  }
}

/// Of `offset` and `scale`: with coordinates that are float nothing overflows in double.
constexpr double kMostTextureMove = 1e6;

/// What the extension of an image of these bytes would be.
const char* extension_of_bytes(std::span<const std::byte> bytes) {
  const auto begins = [&](std::string_view mark) {
    return bytes.size() >= mark.size() &&
           std::string_view(reinterpret_cast<const char*>(bytes.data()), mark.size()) == mark;
  };
  return begins("\x89PNG") ? ".png" : begins("\xff\xd8") ? ".jpg" : begins("RIFF") ? ".webp" : "";
}

}  // namespace

struct GltfMaterials::Reader {
  GltfMaterials& all;
  GltfValue value;
  MaterialDescription& m;
  PrincipledMaterial p = usual_principled();
  double alpha = 1;

  /// A texture and the coordinates that it is looked up with. `factor` stays.
  void use_texture(const GltfValue& info, PrincipledInput input, TextureChannel channel, Colors colors,
                   ImagePart part = ImagePart::color) {
    PrincipledSource& source = p[input];
    source.texture = all.texture(info.index("index", all.file_.count("textures")), part, colors);
    if (source.texture == kNone) return;
    source.channel = channel;
    uint64_t set = info.whole_number("texCoord", 0);
    Vec2 offset(0), scale(1);
    double rotation = 0;
    if (const auto transform = info.extension("KHR_texture_transform")) {
      const auto pair = [&](const char* key, Vec2& to) {
        const auto v = transform->find(key);
        if (!v) return;
        const std::vector<double> numbers = v->numbers(2);
        to = {numbers[0], numbers[1]};
        if (max_magnitude(Vec3(to, 0)) > kMostTextureMove)
          v->fail(
              fmt::format("numbers from -{0:g} to {0:g} were expected: a texture that repeats more often "
                          "between two corners is not there to be seen",
                          kMostTextureMove));
      };
      pair("offset", offset);
      pair("scale", scale);
      rotation = transform->number_in("rotation", 0, -1e4, 1e4);
      set = transform->whole_number("texCoord", set);
    }
    if (set > 1) {
      all.note_once("textures that use TEXCOORD_2 or more are shown with TEXCOORD_0");
      set = 0;
    }
    source.uv_set = static_cast<uint32_t>(set);
    // glTF's v runs down, Rayfarm's up, as meshes have it: (u, 1 - v) are scaled, turned against the clock as
    // the picture is seen, and moved; and then the second is counted from below again.
    const SineCosine turn = portable_sine_cosine(rotation);
    const Vec2 x = Vec2(turn.cosine, turn.sine) * scale, y = Vec2(-turn.sine, turn.cosine) * scale;
    source.u_row = {x.x, -x.y, x.y + offset.x};
    source.v_row = {-y.x, y.y, 1 - y.y - offset.y};
  }

  void use_number(const GltfValue& owner, const char* factor_key, double usual, const char* texture_key,
                  PrincipledInput input, TextureChannel channel, ImagePart part = ImagePart::color) {
    if (factor_key) p[input].factor = Color(owner.number_in(factor_key, usual, 0, 1));
    if (const auto info = owner.find(texture_key)) use_texture(*info, input, channel, Colors::numbers, part);
  }

  static Color color(const GltfValue& owner, const char* key, Color usual, double most) {
    const auto v = owner.find(key);
    if (!v) return usual;
    const Color c = v->vector3();
    for (int i = 0; i < 3; ++i)
      if (!(c[i] >= 0 && c[i] <= most)) v->fail(fmt::format("numbers from 0 to {:g} were expected", most));
    return c;
  }

  void read_base() {
    const auto pbr = value.find("pbrMetallicRoughness");
    p[PrincipledInput::metallic].factor = p[PrincipledInput::roughness].factor = Color(1);
    if (!pbr) return;
    if (const auto v = pbr->find("baseColorFactor")) {
      const std::vector<double> rgba = v->numbers(4);
      for (int i = 0; i < 4; ++i)
        if (!(rgba[static_cast<size_t>(i)] >= 0)) v->fail("numbers from 0 to 1 were expected");
      m.color = glm::min(Color(rgba[0], rgba[1], rgba[2]), Color(1));
      alpha = std::min(rgba[3], 1.0);
    }
    if (const auto info = pbr->find("baseColorTexture"))
      use_texture(*info, PrincipledInput::base_color, TextureChannel::color, Colors::srgb);
    use_number(*pbr, "metallicFactor", 1, "metallicRoughnessTexture", PrincipledInput::metallic,
               TextureChannel::blue);
    use_number(*pbr, "roughnessFactor", 1, "metallicRoughnessTexture", PrincipledInput::roughness,
               TextureChannel::green);
  }

  void read_normal(const GltfValue& owner, const char* key, PrincipledInput input) {
    const auto info = owner.find(key);
    if (!info) return;
    p[input].factor = Color(info->number_in("scale", 1, -100, 100));
    use_texture(*info, input, TextureChannel::color, Colors::numbers);
  }

  void read_emission() {
    m.emission = color(value, "emissiveFactor", Color(0), 1e9);
    if (const auto strength = value.extension("KHR_materials_emissive_strength"))
      m.emission *= strength->number_in("emissiveStrength", 1, 0, 1e9);
    const auto info = value.find("emissiveTexture");
    if (!info || m.emission == Color(0)) return;
    use_texture(*info, PrincipledInput::emission, TextureChannel::color, Colors::srgb);
    all.note_once(
        "materials shine by a texture and are no lamps: rays find their light by chance alone, in `path` and "
        "`thesis` with noise, in the other models not at all");
  }

  void read_surface() {
    if (const auto ior = value.extension("KHR_materials_ior"))
      p.ior =
          ior->number("ior", 1.5) == 0 ? 1000 : ior->number_in("ior", 1.5, 1, 1000);  // 0: it reflects all
    if (const auto specular = value.extension("KHR_materials_specular")) {
      use_number(*specular, "specularFactor", 1, "specularTexture", PrincipledInput::specular,
                 TextureChannel::red, ImagePart::alpha);
      p[PrincipledInput::specular_color].factor = color(*specular, "specularColorFactor", Color(1), 1e6);
      if (const auto info = specular->find("specularColorTexture"))
        use_texture(*info, PrincipledInput::specular_color, TextureChannel::color, Colors::srgb);
    }
    if (const auto coat = value.extension("KHR_materials_clearcoat")) {
      use_number(*coat, "clearcoatFactor", 0, "clearcoatTexture", PrincipledInput::clearcoat,
                 TextureChannel::red);
      use_number(*coat, "clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture",
                 PrincipledInput::clearcoat_roughness, TextureChannel::green);
      read_normal(*coat, "clearcoatNormalTexture", PrincipledInput::clearcoat_normal);
    }
  }

  /// A body if it has a thickness, whose attenuation is that of all the way through it; else a sheet.
  void read_inside() {
    if (const auto v = value.extension("KHR_materials_transmission"))
      use_number(*v, "transmissionFactor", 0, "transmissionTexture", PrincipledInput::transmission,
                 TextureChannel::red);
    const bool is_clear = p[PrincipledInput::transmission].factor.x > 0;
    const auto volume = value.extension("KHR_materials_volume");
    if (!volume) return;
    m.is_solid = is_clear && volume->number_in("thicknessFactor", 0, 0, 1e15) > 0;
    if (volume->has("thicknessTexture"))
      all.note_once("`thicknessTexture` is not used: light goes through bodies as thick as they are");
    if (!m.is_solid) return;
    m.index = p.ior;
    const Color left = color(*volume, "attenuationColor", Color(1), 1);
    if (!volume->has("attenuationDistance")) return;  // infinite
    const double distance = volume->number_in("attenuationDistance", 1, 1e-12, 1e300);
    for (int c = 0; c < 3; ++c) m.filter[c] = portable_pow(left[c], 1 / distance);
  }

  void read_opacity(bool has_vertex_opacity) {
    const std::string mode = value.text("alphaMode", "OPAQUE");
    p.is_one_sided = !value.boolean("doubleSided", false) && !m.is_solid;
    if (mode == "OPAQUE") return;
    if (mode != "MASK" && mode != "BLEND") value.at("alphaMode").fail("OPAQUE, MASK or BLEND was expected");
    PrincipledSource& opacity = p[PrincipledInput::opacity];
    opacity.factor = Color(alpha);
    if (mode == "MASK") {
      const double cutoff = value.number_in("alphaCutoff", 0.5, 0, 1e9);
      if (cutoff == 0) {  // nothing is below it
        opacity.factor = Color(1);
        return;
      }
      p.cutoff = std::min(cutoff, 1.0);
      if (cutoff > 1) opacity.factor = Color(0);
    }
    const PrincipledSource& base = p[PrincipledInput::base_color];
    if (base.texture != kNone) {
      const GltfValue info = value.at("pbrMetallicRoughness").at("baseColorTexture");
      use_texture(info, PrincipledInput::opacity, TextureChannel::red, Colors::numbers, ImagePart::alpha);
    }
    has_open_vertices = has_vertex_opacity;
  }

  void read(bool has_vertex_opacity) {
    read_base();
    m.is_unlit = value.extension("KHR_materials_unlit").has_value();
    if (!m.is_unlit) {
      read_normal(value, "normalTexture", PrincipledInput::normal);
      read_emission();
      read_surface();
      read_inside();
      if (value.has("occlusionTexture"))
        all.note_once("`occlusionTexture` is not used: what is in the dark is computed");
    }
    read_opacity(has_vertex_opacity);
  }
  bool has_open_vertices = false;
};

void GltfMaterials::note_once(const char* what) {
  if (noted_.insert(what).second) scene_.notes.add({file_.path()}, what);
}

uint32_t GltfMaterials::texture(uint32_t index, ImagePart part, Colors colors) {
  if (index == kNone) return kNone;
  const GltfValue texture = file_.item("textures", index);
  uint32_t source = texture.index("source", file_.count("images"));
  if (source == kNone)
    if (const auto webp = texture.extension("EXT_texture_webp"))
      source = webp->index("source", file_.count("images"));
  if (source == kNone) {
    note_once("a texture has no image that is read here, and is left out");
    return kNone;
  }
  return image(source, texture.index("sampler", file_.count("samplers")), part, colors);
}

uint32_t GltfMaterials::image(uint32_t source, uint32_t sampler, ImagePart part, Colors colors) {
  const auto [known, is_new] = images_.try_emplace({source, sampler, part, colors}, kNone);
  if (!is_new) return known->second;
  const GltfValue value = file_.item("images", source);
  TextureDescription texture;
  texture.name = file_.name_of(value);
  if (sampler != kNone) {
    const GltfValue s = file_.item("samplers", sampler);
    texture.wraps = {wrap_of(s, "wrapS"), wrap_of(s, "wrapT")};
    texture.is_nearest = s.whole_number("magFilter", 9729) == 9728;
  }
  using Encoding = ImageReading::Encoding;
  const ImageReading reading{part, colors == Colors::srgb ? Encoding::srgb : Encoding::linear};
  const auto uri = value.find("uri");
  const auto embedded = [&](std::span<const std::byte> bytes) {
    return ImageFile(fmt::format("{}: image {}{}", file_.path(), source, extension_of_bytes(bytes)), bytes);
  };
  const auto file_of_image = [&]() -> ImageFile {
    if (!uri) {
      const uint32_t view = value.index("bufferView", file_.count("bufferViews"));
      if (view == kNone) value.fail("it has neither `uri` nor `bufferView`, and so no pixels");
      return embedded(file_.view(view).bytes);
    }
    if (const auto path = file_.path_of_uri(*uri)) return {*path};
    return embedded(file_.bytes_of_uri(*uri));
  };
  try {
    const ImageFile file = file_of_image();
    if (part == ImagePart::alpha && !ImageReader(file, limits::kTexturePixels).has_alpha())
      return kNone;  // it is 1 everywhere
    load_scene_image(scene_, file, texture, file_.options().stop, reading);
  } catch (const IoError& e) {
    if (uri) file_.fail_of_uri(*uri, e.what());
    value.fail(e.what());
  }
  // `known` is still there: nothing else was looked up meanwhile.
  known->second = static_cast<uint32_t>(scene_.textures.size());
  scene_.textures.push_back(std::move(texture));
  return known->second;
}

uint32_t GltfMaterials::material(uint32_t index, bool has_opacity) {
  const auto [known, is_new] = made_.try_emplace({index, has_opacity}, kNone);
  if (!is_new) return known->second;
  MaterialDescription m("glTF's own");
  PrincipledMaterial p = usual_principled();
  bool has_open_vertices = false;
  m.color = Color(1);
  if (index == kNone) {
    p[PrincipledInput::metallic].factor = p[PrincipledInput::roughness].factor = Color(1);
    p.is_one_sided = 1;
  } else {
    const GltfValue value = file_.item("materials", index);
    m.name = file_.name_of(value);
    Reader reader{*this, value, m};
    reader.read(has_opacity);
    p = reader.p;
    has_open_vertices = reader.has_open_vertices;
  }
  m.principled = static_cast<uint32_t>(scene_.principled.size());
  finish_principled(p, m);
  if (has_open_vertices) m.is_pierced = 1;
  scene_.principled.push_back(p);
  known->second = static_cast<uint32_t>(scene_.materials.size());
  scene_.materials.push_back(std::move(m));
  return known->second;
}

}  // namespace rayfarm
