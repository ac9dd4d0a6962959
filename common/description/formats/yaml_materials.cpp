#include "common/description/formats/yaml_materials.h"

#include <fmt/core.h>

#include <numbers>

#include "common/description/formats/ies_loader.h"
#include "common/description/formats/yaml_mix.h"
#include "common/description/formats/yaml_principled.h"
#include "common/description/formats/yaml_spectra.h"
#include "common/description/formats/yaml_textures.h"
#include "common/materials/fresnel.h"
#include "common/materials/presets.h"
#include "common/materials/scattering.h"
#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {
namespace {

/// Light that comes out must not be more than what went in.
void require_energy(const YamlValue& value, bool is_allowed, double most, const std::string& what) {
  if (most > 1 + 1e-9 && !is_allowed)
    value.fail(
        fmt::format("the material sends out {:.4g} times the light that it receives ({}); lower it to 1, or "
                    "write `allow_impossible: true` if you want a surface that can't be",
                    most, what));
}

double normal_reflectance(double index) {
  return fresnel_dielectric(1, index);
}

double read_exponent(YamlMap& map) {
  const auto v = map.find("exponent");
  return v ? v->number_in(0, 1e6) : 0;
}
double read_index(YamlMap& map, double fallback) {
  const auto v = map.find("index");
  return v ? v->number_in(1e-3, 1e3) : fallback;
}
Color read_albedo(const YamlValue& value, MaterialDescription& m, SpectralField field, bool is_allowed,
                  const std::string& what) {
  const Color c = read_color(value, field, m.spectra);
  require_energy(value, is_allowed, largest_value(m, [&](double nm) { return value_at(m, field, c, nm); }),
                 what);
  return c;
}
Color read_albedo(YamlMap& map, const char* key, MaterialDescription& m, SpectralField field,
                  const Color& fallback, bool is_allowed) {
  const auto v = map.find(key);
  return v ? read_albedo(*v, m, field, is_allowed, fmt::format("`{}`", key)) : fallback;
}

void read_classical(YamlMap& map, MaterialDescription& m, bool is_allowed) {
  const auto coefficient = [&map](const char* name, double& target) {
    if (auto found = map.find(name)) target = found->number_in(0, 1e6);
  };
  if (auto c = map.find("color")) m.color = read_color(*c, SpectralField::color, m.spectra);
  coefficient("ambient", m.ambient);
  coefficient("diffuse", m.diffuse);
  coefficient("specular", m.specular);
  const bool has_shininess = map.find("shininess").has_value();
  coefficient("shininess", m.shininess);
  coefficient("reflect", m.reflect);
  coefficient("transmit", m.transmit);
  m.index = read_index(map, 1);
  if (const auto interior = map.find("interior")) {
    if (!(m.transmit > 0)) interior->fail("`interior` weighs what `transmit` lets through; give that, too");
    m.interior = read_albedo(*interior, m, SpectralField::interior, is_allowed, "`interior`");
  }
  if (const auto exponent = map.find("exponent")) {
    if (!(m.reflect > 0 || m.transmit > 0))
      exponent->fail(
          "`exponent` spreads what `reflect` and `transmit` send on; give one of them, too, or `shininess` "
          "for highlights alone");
    m.exponent = exponent->number_in(0, 1e6);
    if (m.exponent > 0 && !has_shininess) m.shininess = m.exponent;
  }
  const auto sent = [&m](double nm) {
    return value_at(m, SpectralField::color, m.color, nm) * m.diffuse + m.reflect +
           m.transmit * value_at(m, SpectralField::interior, m.interior, nm);
  };
  require_energy(map.value(), is_allowed, largest_value(m, sent),
                 "`color` × `diffuse` + `reflect` + `transmit` × `interior`");
}

/// One of the two parts of a metal's index: three numbers are at the wavelengths of red, green and blue.
Color read_constants(const YamlValue& value, SpectralField field, MaterialDescription& m) {
  const Color c = read_color(value, field, m.spectra);
  if (value.is_map()) return c;
  const Vec3 nm = ColourPass{}.wavelengths_nm;
  m.spectra.push_back({field, 0, {{nm.z, c.z}, {nm.y, c.y}, {nm.x, c.x}}});
  return c;
}

void read_conductor(const YamlValue& value, MaterialDescription& m) {
  const auto use_preset = [&m](const YamlValue& at) {
    const auto metal = find_conductor(at.text());
    if (!metal) at.fail_unknown("metal", conductor_names(), "; n and k can be given, too");
    m.metal = *metal;
    for (int c = 0; c < 3; ++c) {
      const ConductorConstants constants = conductor_at(*metal, ColourPass{}.wavelengths_nm[c]);
      m.n[c] = constants.n;
      m.k[c] = constants.k;
    }
  };
  if (!value.is_map()) {
    use_preset(value);
  } else {
    YamlMap map(value);
    if (auto metal = map.find("metal")) {
      use_preset(*metal);
    } else {
      m.n = read_constants(map.require("n"), SpectralField::n, m);
      m.k = read_constants(map.require("k"), SpectralField::k, m);
    }
    m.exponent = read_exponent(map);
    map.finish();
  }
  m.color = fresnel_conductor(1, m.n, m.k);
  m.specular = m.reflect = luminance(m.color);
}

void read_dielectric(const YamlValue& value, MaterialDescription& m) {
  m.index = 1.5;
  if (!value.is_map()) {
    const auto constants = find_dielectric(value.text());
    if (!constants) value.fail_unknown("substance", dielectric_names(), "; an index can be given, too");
    m.index = constants->index;
    m.abbe = constants->abbe;
  } else {
    YamlMap map(value);
    m.index = map.require("index").number_in(1e-3, 1e3);
    if (auto filter = map.find("filter")) {
      m.filter = read_albedo(*filter, m, SpectralField::filter, false, "`filter`");
    }
    m.exponent = read_exponent(map);
    if (auto abbe = map.find("abbe")) m.abbe = abbe->number_in(1, 1e6);
    if (auto priority = map.find("priority")) m.priority = priority->whole_number_in(-1000, 1000);
    map.finish();
  }
  m.reflect = m.specular = normal_reflectance(m.index);
  m.transmit = 1 - m.reflect;
}

void read_polished(const YamlValue& value, MaterialDescription& m, bool is_allowed) {
  YamlMap map(value);
  m.color = read_albedo(map, "color", m, SpectralField::color, Color(0.5), is_allowed);
  m.index = read_index(map, 1.5);
  m.exponent = read_exponent(map);
  map.finish();
  m.reflect = m.specular = normal_reflectance(m.index);
  m.diffuse = 1 - m.reflect;
}

void read_translucent(const YamlValue& value, MaterialDescription& m, bool is_allowed) {
  YamlMap map(value);
  m.color = read_albedo(map, "front", m, SpectralField::color, Color(0.5), is_allowed);
  if (!map.has("back"))  // it is as the front
    for (SpectrumDescription& front : std::vector(m.spectra)) {
      front.field = SpectralField::back;
      m.spectra.push_back(std::move(front));
    }
  m.back = read_albedo(map, "back", m, SpectralField::back, m.color, is_allowed);
  m.through = read_albedo(map, "through", m, SpectralField::through, Color(0.3), is_allowed);
  map.finish();
  const auto sent = [&m](double nm) {
    return glm::max(value_at(m, SpectralField::color, m.color, nm),
                    value_at(m, SpectralField::back, m.back, nm)) +
           value_at(m, SpectralField::through, m.through, nm);
  };
  require_energy(value, is_allowed, largest_value(m, sent), "`front` or `back` + `through`");
  m.diffuse = 1;
}

/// A diagram's horizontal angle 0 lies towards `toward`, as far as that is across the light's direction.
Vec3 across(const Vec3& direction, const Vec3& toward) {
  const Vec3 v = normalized(toward - glm::dot(toward, direction) * direction);
  return max_magnitude(v) > 0 ? v : Frame(direction).tangent;
}

/// Reads a photometric file into the scene's diagrams; returns its index.
uint32_t read_diagram(const YamlValue& file, YamlDocument& document) {
  SceneDescription& scene = document.scene();
  const std::string path = document.path_of(file);
  DiagramDescription diagram;
  try {
    diagram.values = load_ies(path, diagram, file.stop());
  } catch (const IoError& e) {
    file.fail(e.what());
  }
  scene.diagrams.push_back(std::move(diagram));
  scene.files.push_back(path);
  return static_cast<uint32_t>(scene.diagrams.size() - 1);
}

/// How a luminaire's radiance differs by direction: relative to the file's largest intensity.
void read_luminaire_diagram(YamlMap& map, MaterialDescription& m, YamlDocument& document) {
  const auto ies = map.find("ies");
  if (!ies) {
    for (const char* key : {"direction", "zero"})
      if (const auto idle = map.find(key))
        idle->fail(fmt::format("`{}` turns the diagram of a photometric file; give `ies`, too", key));
    return;
  }
  const auto direction = map.find("direction"), zero = map.find("zero");
  if (m.exponent > 0)
    ies->fail("give either `ies` or `exponent`: each says how the light falls off to the sides");
  m.diagram = read_diagram(*ies, document);
  DiagramDescription& diagram = document.scene().diagrams.back();
  const auto intensities =
      std::span(diagram.values).subspan(diagram.vertical_count + diagram.horizontal_count);
  const double largest = *std::max_element(intensities.begin(), intensities.end());
  if (!(largest > 0)) ies->fail("the photometric file has no intensity above 0: nothing would shine");
  for (double& value : intensities) value /= largest;
  if (direction) m.diagram_axis = normalized(direction->direction());
  m.diagram_zero = across(m.diagram_axis, zero ? zero->direction() : Vec3(1, 0, 0));
}

void read_luminaire(const YamlValue& value, MaterialDescription& m, bool is_allowed, YamlDocument& document) {
  YamlMap map(value);
  m.color = read_albedo(map, "color", m, SpectralField::color, Color(0), is_allowed);
  m.emission = read_color(map.require("emission"), SpectralField::emission, m.spectra);
  m.exponent = read_exponent(map);
  if (auto inward = map.find("inward")) m.is_inward = inward->boolean() ? 1 : 0;
  read_luminaire_diagram(map, m, document);
  map.finish();
  m.diffuse = 1;
}

}  // namespace

MaterialDescription read_material(const std::string& name, const YamlValue& value, YamlDocument& document) {
  YamlMap map(value);
  MaterialDescription m(name);
  if (const auto mix = map.find("mix")) {
    for (const auto& [key, other] : value.entries())
      if (key.text() != "mix") key.fail("a mix is nothing but its parts; give this key to them");
    m.kind = MaterialKind::mix;
    read_mix(*mix, m, document);
    return m;
  }
  const auto allow = map.find("allow_impossible");
  const bool is_allowed = allow && allow->boolean();
  for (MaterialKind family = MaterialKind::lambertian; family <= MaterialKind::luminaire;
       family = static_cast<MaterialKind>(static_cast<uint32_t>(family) + 1)) {
    const auto v = map.find(kMaterialKindWords[static_cast<size_t>(family)]);
    if (!v) continue;
    if (m.kind != MaterialKind::classical) v->fail("a material is of one family only");
    m.kind = family;
    m.ambient = m.diffuse = m.specular = 0;
    switch (m.kind) {
      case MaterialKind::classical:
      case MaterialKind::mix:
      case MaterialKind::principled:
        break;
      case MaterialKind::lambertian: {
        m.color = read_albedo(*v, m, SpectralField::color, is_allowed, "its colour");
        m.diffuse = 1;
        break;
      }
      case MaterialKind::conductor:
        read_conductor(*v, m);
        break;
      case MaterialKind::dielectric:
        read_dielectric(*v, m);
        break;
      case MaterialKind::polished:
        read_polished(*v, m, is_allowed);
        break;
      case MaterialKind::translucent:
        read_translucent(*v, m, is_allowed);
        break;
      case MaterialKind::luminaire:
        read_luminaire(*v, m, is_allowed, document);
        break;
    }
    if (m.exponent > 0) m.shininess = m.exponent;
  }
  if (const auto v = map.find("principled")) {
    if (m.kind != MaterialKind::classical) v->fail("a material is of one family only");
    map.refuse("texture", "a principled material names textures inside: `base_color: NAME`");
    map.refuse("bump", "a principled material names a map of normals inside: `normal: NAME`");
    read_principled(*v, m, document);
  }
  if (auto texture = map.find("texture")) m.texture = find_texture(*texture, document);
  if (auto v = map.find("bump")) {
    YamlMap bump(*v);
    m.bump = find_texture(bump.require("texture"), document);
    m.bump_height = bump.require("height").number_in(-1e9, 1e9);
    bump.finish();
  }
  if (auto v = map.find("reflections"))
    m.reflections = static_cast<Reflections>(v->choice({"true", "specular", "false"}));
  if (m.kind == MaterialKind::classical) read_classical(map, m, is_allowed);
  map.finish();
  return m;
}

uint32_t find_material(const YamlValue& value, YamlDocument& document, const std::string& otherwise) {
  return document.shared.materials.find_or_make(
      value,
      [&](const std::string& name) {
        MaterialDescription material = read_material(name, value, document);
        document.scene().materials.push_back(std::move(material));
        return static_cast<uint32_t>(document.scene().materials.size() - 1);
      },
      otherwise);
}

Light read_light(const YamlValue& value, YamlDocument& document, std::vector<SpectrumDescription>& spectra) {
  YamlMap map(value);
  Light light;
  const auto position = map.find("position"), direction = map.find("direction");
  if (!position && !direction)
    value.fail("a light has a `position` (a point), a `direction` (far away), or both (a spot)");
  if (position) light.position = position->vector();
  if (direction) light.direction = normalized(direction->direction());
  const auto falloff = map.find("falloff");
  if (!position) {
    light.kind = LightKind::distant;
    if (falloff) falloff->fail("a distant light has no falloff");
  } else if (falloff && falloff->boolean()) {
    light.kind = LightKind::bulb;
  }
  if (const auto ies = map.find("ies")) {
    if (!position) ies->fail("a light with a photometric file stands somewhere: it needs a `position`");
    light.kind = LightKind::bulb;
    const auto zero = map.find("zero");
    light.zero = across(light.direction, zero ? zero->direction() : Vec3(1, 0, 0));
    light.diagram = read_diagram(*ies, document);
  } else if (position && direction) {
    light.kind = LightKind::spot;
    if (falloff && !falloff->boolean())
      falloff->fail("a spot always falls off with the square of the distance");
    const double radians = std::numbers::pi / 180;
    const double full = map.require("angle").number_in(0, 180);
    const auto dark = map.find("dark_angle");
    const double none = dark ? dark->number_in(full, 180) : full;
    light.cosine_full = portable_cos(full * radians);
    light.cosine_none = portable_cos(none * radians);
  }
  const size_t before = spectra.size();
  if (auto v = map.find("color"))
    light.color = read_color(*v, SpectralField::light, spectra, document.scene().lights.size());
  if (auto v = map.find("intensity")) {
    const double factor = v->number_in(0, 1e9);
    light.color *= factor;
    for (size_t i = before; i < spectra.size(); ++i)
      for (SpectrumNode& node : spectra[i].nodes) node.value *= factor;
  }
  map.finish();
  return light;
}

}  // namespace rayfarm
