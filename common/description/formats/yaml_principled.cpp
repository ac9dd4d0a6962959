#include "common/description/formats/yaml_principled.h"

#include <fmt/core.h>

#include <numbers>

#include "common/description/formats/yaml_spectra.h"
#include "common/description/formats/yaml_textures.h"
#include "common/materials/principled.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789+-.eE") == std::string::npos;
}

class PrincipledReader {
 public:
  PrincipledReader(const YamlValue& value, MaterialDescription& material, YamlDocument& document)
      : map_(value), m_(material), document_(document), scene_(document.scene()), p_(usual_principled()) {}

  void read() {
    m_.color = Color(0.8);
    read_color_of("base_color", PrincipledInput::base_color, m_.color, SpectralField::color, 1);
    read_scalar("metallic", PrincipledInput::metallic);
    read_scalar("roughness", PrincipledInput::roughness);
    read_scalar("specular", PrincipledInput::specular);
    read_scalar("transmission", PrincipledInput::transmission);
    read_scalar("clearcoat", PrincipledInput::clearcoat);
    read_scalar("clearcoat_roughness", PrincipledInput::clearcoat_roughness);
    read_specular_color();
    read_inside();
    read_emission();
    read_map("normal", PrincipledInput::normal);
    if (map_.has("clearcoat_normal")) need("clearcoat_normal", PrincipledInput::clearcoat, "clearcoat");
    read_map("clearcoat_normal", PrincipledInput::clearcoat_normal);
    if (map_.has("clearcoat_roughness")) need("clearcoat_roughness", PrincipledInput::clearcoat, "clearcoat");
    read_opacity();
    map_.finish();
    m_.principled = static_cast<uint32_t>(scene_.principled.size());
    finish_principled(p_, m_);
    scene_.principled.push_back(p_);
  }

 private:
  /// A key that another makes sense of.
  void need(const char* key, PrincipledInput other, const char* name) {
    if (p_[other].texture == kNone && !(p_[other].factor.x > 0))
      map_.find(key)->fail(fmt::format("`{}` does nothing without `{}`; give that, too", key, name));
  }

  bool has_texture(const YamlValue& value) const {
    return value.is_map() ||
           (!value.is_sequence() && !is_number(value.text()) && !value.text().starts_with('#'));
  }

  /// `NAME`, a texture {kind, …}, or {texture, channel, scale, rotate, offset}; the map's other keys are
  /// `rest`'s.
  template <typename Rest>
  void read_texture_use(const YamlValue& value, PrincipledSource& source, bool has_channels, Rest rest) {
    if (!value.is_map() || YamlMap(value).has("kind")) {
      source.texture = find_texture(value, document_);
      return;
    }
    YamlMap map(value);
    source.texture = find_texture(map.require("texture"), document_);
    if (has_channels)
      if (auto v = map.find("channel"))
        source.channel = static_cast<TextureChannel>(v->choice({"luminance", "r", "g", "b"}));
    Vec2 scale(1), offset(0);
    double degrees = 0;
    const auto pair = [](const YamlValue& v) {
      const std::vector<double> numbers = v.numbers();
      if (numbers.size() != 2) v.fail("two numbers were expected, for u and v");
      return Vec2(numbers[0], numbers[1]);
    };
    if (auto v = map.find("scale")) {
      scale = v->is_sequence() ? pair(*v) : Vec2(v->number());
      if (!(scale.x != 0 && scale.y != 0))
        v->fail("a texture that is repeated 0 times has no colour; give another scale");
    }
    if (auto v = map.find("rotate")) degrees = v->number_in(-3600, 3600);
    if (auto v = map.find("offset")) offset = pair(*v);
    const SineCosine turn = portable_sine_cosine(degrees * std::numbers::pi / 180);
    source.u_row = {turn.cosine * scale.x, -turn.sine * scale.y, offset.x};
    source.v_row = {turn.sine * scale.x, turn.cosine * scale.y, offset.y};
    rest(map);
    map.finish();
  }

  /// Numbers that are no colours must not be decoded as colours.
  void expect_numbers(const YamlValue& value, const char* key, const PrincipledSource& source) {
    const TextureDescription& texture = scene_.textures[source.texture];
    if (!texture.is_from_srgb) return;
    scene_.notes.add(
        scene_.source(value.place()),
        fmt::format("`{}` takes numbers from texture '{}', whose image was decoded from sRGB as if they "
                    "were colours; write `encoding: linear` in the texture if they are none",
                    key, texture.name));
  }

  void read_scalar(const char* key, PrincipledInput input) {
    const auto value = map_.find(key);
    if (!value) return;
    PrincipledSource& source = p_[input];
    if (!has_texture(*value)) {
      source.factor = Color(value->number_in(0, 1));
      return;
    }
    source.factor = Color(1);
    source.channel = TextureChannel::luminance;
    read_texture_use(*value, source, true, [&](YamlMap& map) {
      if (auto v = map.find("factor")) source.factor = Color(v->number_in(0, 1));
    });
    expect_numbers(*value, key, source);
  }

  /// `factor`: what colours without a texture are, and what a texture is multiplied by.
  void read_color_of(const char* key, PrincipledInput input, Color& factor, SpectralField field,
                     double most) {
    const auto value = map_.find(key);
    if (!value) return;
    const auto read_factor = [&](const YamlValue& v) {
      factor = read_color(v, field, m_.spectra);
      if (const double largest =
              largest_value(m_, [&](double nm) { return value_at(m_, field, factor, nm); });
          largest > most + 1e-9)
        v.fail(fmt::format("`{}` must be no more than {:g}, but it is {:.4g}", key, most, largest));
    };
    if (value->is_map() && !YamlMap(*value).has("spectrum")) {
      factor = Color(1);
      read_texture_use(*value, p_[input], false, [&](YamlMap& map) {
        if (auto v = map.find("factor")) read_factor(*v);
      });
    } else if (value->is_map() || !has_texture(*value)) {
      read_factor(*value);
    } else {
      factor = Color(1);
      read_texture_use(*value, p_[input], false, [](YamlMap&) {});
    }
  }

  void read_specular_color() {
    const auto value = map_.find("specular_color");
    if (!value) return;
    PrincipledSource& source = p_[PrincipledInput::specular_color];
    if (!has_texture(*value))
      source.factor = value->color();
    else
      read_texture_use(*value, source, false, [&](YamlMap& map) {
        if (auto v = map.find("factor")) source.factor = v->color();
      });
  }

  void read_inside() {
    if (auto v = map_.find("ior")) p_.ior = v->number_in(1, 100);
    const auto is_there = [&](PrincipledInput input) {
      return p_[input].texture != kNone || p_[input].factor.x > 0;
    };
    const bool is_clear = is_there(PrincipledInput::transmission);
    const auto thin = map_.find("thin");
    const bool is_thin = thin && thin->boolean();
    m_.is_solid = is_clear && !is_thin;
    m_.index = m_.is_solid ? p_.ior : 1;
    for (const char* key : {"thin", "attenuation_color", "attenuation_distance", "abbe", "priority"})
      if (const auto idle = map_.find(key)) {
        if (!is_clear)
          idle->fail(fmt::format("`{}` tells of what light passes; give `transmission`, too", key));
        if (is_thin && std::string_view(key) != "thin")
          idle->fail(fmt::format("`{}` tells of an inside, but with `thin` the surface is a sheet", key));
      }
    const auto color = map_.find("attenuation_color"), distance = map_.find("attenuation_distance");
    if (color.has_value() != distance.has_value())
      (color ? color : distance)
          ->fail("light takes on `attenuation_color` within `attenuation_distance`; give both");
    if (color) {
      const double length = distance->number_in(1e-9, 1e12);
      const Color left = color->color();
      for (int c = 0; c < 3; ++c) {
        if (left[c] > 1) color->fail("`attenuation_color` is what is left of light, 1 at most");
        m_.filter[c] = portable_pow(left[c], 1 / length);
      }
    }
    if (auto v = map_.find("abbe")) m_.abbe = v->number_in(1, 1e6);
    if (auto v = map_.find("priority")) m_.priority = v->whole_number_in(-1000, 1000);
  }

  void read_emission() {
    const double kMost = 1e12;
    read_color_of("emission", PrincipledInput::emission, m_.emission, SpectralField::emission, kMost);
    if (auto v = map_.find("emission_strength")) {
      if (!map_.has("emission")) v->fail("`emission_strength` multiplies `emission`; give that, too");
      const double strength = v->number_in(0, 1e9);
      m_.emission *= strength;
      for (SpectrumDescription& s : m_.spectra)
        if (s.field == SpectralField::emission)
          for (SpectrumNode& node : s.nodes) node.value *= strength;
    }
    if (p_[PrincipledInput::emission].texture != kNone)
      scene_.notes.add(
          scene_.source(map_.find("emission")->place()),
          fmt::format("'{}' shines but is no lamp, as its emission has a texture: rays find its light by "
                      "chance alone, in `path` and `thesis` with noise, in the other models not at all",
                      m_.name));
    const auto unlit = map_.find("unlit");
    if (!unlit || !unlit->boolean()) return;
    m_.is_unlit = 1;
    for (const char* key : {"emission", "metallic", "roughness", "specular", "specular_color", "transmission",
                            "clearcoat", "normal"})
      if (const auto idle = map_.find(key))
        idle->fail(fmt::format("`{}` does nothing where `unlit` shows the base colour as it is", key));
  }

  void read_map(const char* key, PrincipledInput input) {
    const auto value = map_.find(key);
    if (!value) return;
    if (!has_texture(*value)) value->fail("a map of normals is a texture: give its name");
    PrincipledSource& source = p_[input];
    read_texture_use(*value, source, false, [&](YamlMap& map) {
      if (auto v = map.find("strength")) source.factor = Color(v->number_in(-100, 100));
    });
    expect_numbers(*value, key, source);
  }

  void read_opacity() {
    read_scalar("opacity", PrincipledInput::opacity);
    if (auto v = map_.find("cutoff")) {
      if (!map_.has("opacity")) v->fail("`cutoff` decides where `opacity` is nothing; give that, too");
      p_.cutoff = v->number_in(1e-6, 1);
    }
    if (auto v = map_.find("one_sided")) p_.is_one_sided = v->boolean() ? 1 : 0;
  }

  YamlMap map_;
  MaterialDescription& m_;
  YamlDocument& document_;
  SceneDescription& scene_;
  PrincipledMaterial p_;
};

}  // namespace

void read_principled(const YamlValue& value, MaterialDescription& material, YamlDocument& document) {
  PrincipledReader(value, material, document).read();
}

}  // namespace rayfarm
