// Materials and textures of glTF files.
#include "tests/unit/tiny_gltf.h"

namespace rayfarm {
namespace {

using test::notes_of;
using test::square_and;
using test::TinyGltf;

/// The principled material of a file's only mesh.
struct OneMaterial {
  OneMaterial(const std::string& json, const std::string& lists = "") {
    TinyGltf file;
    scene = file.load(square_and(file,
                                 fmt::format(R"("nodes": [{{"mesh": 0}}], "materials": [{}]{}{})", json,
                                             lists.empty() ? "" : ", ", lists),
                                 R"(, "material": 0)"));
    uint32_t index = kNone;
    for (const ObjectDescription& object : scene.objects)
      if (!object.primitives.empty() && std::holds_alternative<MeshShape>(object.primitives[0].shape))
        index = object.primitives[0].material;
    m = scene.materials.at(index);
    p = scene.principled.at(m.principled);
  }
  double factor(PrincipledInput input) const { return p[input].factor.x; }
  SceneDescription scene;
  MaterialDescription m;
  PrincipledMaterial p;
};

TEST(GltfMaterial, HasThePrincipledParameters) {
  const OneMaterial usual("{}");
  EXPECT_EQ(usual.m.color, Color(1));
  EXPECT_EQ(usual.factor(PrincipledInput::metallic), 1);
  EXPECT_EQ(usual.factor(PrincipledInput::roughness), 1);
  EXPECT_TRUE(usual.p.is_one_sided);
  const OneMaterial m(R"({"name": "all", "doubleSided": true, "emissiveFactor": [0.5, 1, 0],
      "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.25, "roughnessFactor": 0.75},
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}, "KHR_materials_ior": {"ior": 1.33},
        "KHR_materials_specular": {"specularFactor": 0.6, "specularColorFactor": [1, 2, 3]},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.9, "clearcoatRoughnessFactor": 0.1},
        "KHR_materials_transmission": {"transmissionFactor": 0.8}}})");
  EXPECT_EQ(m.m.name, "all");
  EXPECT_EQ(m.m.color, Color(0.1, 0.2, 0.3));
  EXPECT_EQ(m.m.emission, Color(2, 4, 0));
  EXPECT_EQ(m.factor(PrincipledInput::metallic), 0.25);
  EXPECT_EQ(m.factor(PrincipledInput::roughness), 0.75);
  EXPECT_EQ(m.factor(PrincipledInput::specular), 0.6);
  EXPECT_EQ(m.p[PrincipledInput::specular_color].factor, Color(1, 2, 3));
  EXPECT_EQ(m.factor(PrincipledInput::clearcoat), 0.9);
  EXPECT_EQ(m.factor(PrincipledInput::clearcoat_roughness), 0.1);
  EXPECT_EQ(m.factor(PrincipledInput::transmission), 0.8);
  EXPECT_EQ(m.p.ior, 1.33);
  EXPECT_FALSE(m.m.is_solid) << "a sheet, without a thickness";
  EXPECT_EQ(m.factor(PrincipledInput::opacity), 1) << "OPAQUE: alpha is not looked at";
  EXPECT_FALSE(m.m.is_pierced);
}

TEST(GltfMaterial, BodiesTakeLightByTheWayThroughThem) {
  const OneMaterial m(R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
      "KHR_materials_ior": {"ior": 1.7}, "KHR_materials_volume": {"thicknessFactor": 2,
        "attenuationColor": [1, 0.25, 0.04], "attenuationDistance": 2}}})");
  EXPECT_TRUE(m.m.is_solid);
  EXPECT_EQ(m.m.index, 1.7);
  EXPECT_NEAR(glm::length(m.m.filter - Color(1, 0.5, 0.2)), 0, 1e-12);
  EXPECT_FALSE(m.p.is_one_sided) << "rays leave it from within";
}

TEST(GltfMaterial, IsOpenByMaskAndBlend) {
  const OneMaterial blend(
      R"({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.3]}})");
  EXPECT_EQ(blend.factor(PrincipledInput::opacity), 0.3);
  EXPECT_EQ(blend.p.cutoff, 0);
  EXPECT_TRUE(blend.m.is_pierced);
  const OneMaterial mask(R"({"alphaMode": "MASK", "alphaCutoff": 0.7, "doubleSided": true,
      "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.8]}})");
  EXPECT_EQ(mask.p.cutoff, 0.7);
  EXPECT_FALSE(mask.m.is_pierced) << "all of it is above";
  const OneMaterial unlit(
      R"({"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 1, 1]}})");
  EXPECT_TRUE(unlit.m.is_unlit);
  EXPECT_EQ(unlit.m.emission, Color(1, 0, 1));
}

/// Writes a picture of 2 × 1 pixels beside the test's files.
void write_two_pixels(const std::string& name, std::array<uint8_t, 6> rgb) {
  Image image;
  image.width_px = 2;
  image.height_px = 1;
  image.window = {0, 0, 2, 1};
  image.layout = make_pixel_layout(PixelFormat::rgb8);
  for (const uint8_t value : rgb) image.pixels.push_back(std::byte{value});
  write_image(test::write_temporary(name, ""), image, {});
}

TEST(GltfMaterial, TexturesWithoutCoordinatesAreNamed) {
  write_two_pixels("two.png", {128, 64, 32, 255, 0, 255});
  const auto notes_with = [](int set, bool has_first) {
    test::TinyGltf file;
    const size_t p = file.square(), t = file.floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1}, 2);
    const std::string first = has_first ? fmt::format(R"(, "TEXCOORD_0": {})", t) : "";
    return test::notes_of(compile(file.load(
        test::shows(
            fmt::format(R"("attributes": {{"POSITION": {}{}}}, "mode": 6, "material": 0)", p, first)) +
        fmt::format(R"(, "images": [{{"uri": "two.png"}}], "textures": [{{"source": 0}}], "materials": [{{
          "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0, "texCoord": {}}}}}}}])",
                    set))));
  };
  EXPECT_EQ(notes_with(0, true).find("primitive"), std::string::npos);
  EXPECT_NE(notes_with(0, false).find("1 primitive with textures but without TEXCOORD_0"), std::string::npos);
  EXPECT_NE(notes_with(1, true).find("1 primitive with textures for TEXCOORD_1 but without that"),
            std::string::npos);
}

TEST(GltfMaterial, TexturesAreDecodedAndTransformed) {
  write_two_pixels("two.png", {128, 64, 32, 255, 0, 255});
  const OneMaterial m(
      R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1, "extensions": {
        "KHR_texture_transform": {"offset": [0.1, 0.2], "rotation": 0.5, "scale": [2, 3], "texCoord": 0}}},
        "metallicRoughnessTexture": {"index": 1, "texCoord": 1}}, "normalTexture": {"index": 1, "scale": 0.5},
        "occlusionTexture": {"index": 1}})",
      R"("images": [{"uri": "two.png"}], "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0}, {"source": 0}])");
  const PrincipledSource& base = m.p[PrincipledInput::base_color];
  const TextureDescription& colors = m.scene.textures[base.texture];
  EXPECT_TRUE(colors.is_from_srgb);
  EXPECT_EQ(colors.wraps[0], TextureWrap::clamp);
  EXPECT_EQ(colors.wraps[1], TextureWrap::mirror);
  EXPECT_TRUE(colors.is_nearest);
  const PrincipledSource& metallic = m.p[PrincipledInput::metallic];
  EXPECT_EQ(metallic.channel, TextureChannel::blue);
  EXPECT_EQ(m.p[PrincipledInput::roughness].channel, TextureChannel::green);
  EXPECT_EQ(metallic.texture, m.p[PrincipledInput::normal].texture) << "one image of numbers";
  EXPECT_EQ(metallic.uv_set, 1u);
  EXPECT_EQ(base.uv_set, 0u) << "the transform's";
  EXPECT_FALSE(m.scene.textures[metallic.texture].is_from_srgb);
  EXPECT_EQ(m.scene.textures.size(), 2u);
  EXPECT_EQ(m.factor(PrincipledInput::normal), 0.5);
  // "Rotate the UVs by this many radians counter-clockwise around the origin": as the picture is seen, v
  // down.
  const double u = 0.3, v = 0.8, c = std::cos(0.5), s = std::sin(0.5);
  const Vec2 expected(c * 2 * u + s * 3 * v + 0.1, -s * 2 * u + c * 3 * v + 0.2);
  const Vec3 at(u, 1 - v, 1);
  EXPECT_NEAR(glm::dot(base.u_row, at), expected.x, 1e-12);
  EXPECT_NEAR(1 - glm::dot(base.v_row, at), expected.y, 1e-12);
  EXPECT_NEAR(glm::dot(metallic.v_row, at), 1 - v, 1e-15);
  EXPECT_NE(notes_of(compile(m.scene)).find("`occlusionTexture` is not used"), std::string::npos);
}

TEST(GltfMaterial, PicturesMayStandInTheFile) {
  write_two_pixels("two.png", {255, 0, 0, 0, 255, 0});
  std::ifstream in(test::write_temporary("two.png.copy", ""), std::ios::binary);
  const std::string path =
      (std::filesystem::path(test::write_temporary("x", "")).parent_path() / "two.png").string();
  std::ifstream picture(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(picture), {}};
  TinyGltf file;
  const size_t view = file.view(bytes);
  const SceneDescription scene = load_scene(file.write_glb(square_and(
      file,
      fmt::format(R"("nodes": [{{"mesh": 0}}], "images": [{{"bufferView": {}, "mimeType": "image/png"}}],
      "textures": [{{"source": 0}}], "materials": [{{"alphaMode": "BLEND",
        "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}])",
                  view),
      R"(, "material": 0)")));
  ASSERT_EQ(scene.textures.size(), 1u) << "it has no alpha";
  EXPECT_EQ(scene.textures[0].width_px, 2u);
  EXPECT_EQ(scene.textures[0].texels[0], 0x3c00);
  EXPECT_EQ(scene.textures[0].texels[1], 0);
}

}  // namespace
}  // namespace rayfarm
