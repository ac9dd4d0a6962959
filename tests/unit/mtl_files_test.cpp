// MTL files: what they say becomes materials, or is noted.
#include "common/image/half_float.h"
#include "common/lighting/principled_surface.h"
#include "common/scene/light.h"
#include "tests/unit/mesh_files.h"

namespace rayfarm {
namespace {

using test::error_of_mesh;
using test::expect_note;
using test::kFace;
using test::kTriangle;
using test::load_mesh;
using test::notes_of;
using test::write_temporary;
using test::write_two_colours;

/// What the material of a triangle is, where a ray sees it.
Color base_color_at(const Scene& s, size_t triangle, const Vec2& uv) {
  const Material& m = s.materials[s.triangle_shading[triangle].material];
  if (m.kind != MaterialKind::principled)
    return m.color * eval_texture(s.textures[m.texture], s.texels, {{}, uv, 0, 0});
  SurfacePatch patch;
  patch.sets[0].uv = uv;
  return eval_principled_point(s, m, patch).base;
}

TEST(MtlLoader, MapsOfColourAreUsed) {
  write_two_colours("two colours.png");
  const SceneDescription scene =
      load_mesh("mtllib mesh.mtl\nusemtl plain\n" + kTriangle + kFace + "usemtl moved\n" + kFace +
                    "usemtl same\n" + kFace + "usemtl clamped\n" + kFace,
                "newmtl plain\nKd 0.5 0.5 0.5\nmap_Kd .\\two colours.png\n"
                "newmtl moved\nmap_Kd -o 0.5 -s 2 -1 1 -clamp off two colours.png\n"
                "newmtl same\nKd 1 0 0\nmap_Kd \"two colours.png\"\n"
                "newmtl clamped\nKd 0 0 0\nmap_kd -blendu on -clamp on two colours.png\n");
  EXPECT_EQ(notes_of(scene), "");
  ASSERT_EQ(scene.textures.size(), 2u) << "an image is read once, and once for edges that go on";
  const CompiledScene compiled = compile(scene);
  const Scene& s = compiled.scene;
  EXPECT_EQ(base_color_at(s, 0, {0.25, 0.5}), Color(0.5, 0, 0));
  EXPECT_EQ(base_color_at(s, 0, {0.75, 0.5}), Color(0, 0.5, 0));
  EXPECT_EQ(base_color_at(s, 1, {0.125, 0.5}), Color(0, 1, 0)) << "0.125 · 2 + 0.5 = 0.75";
  EXPECT_EQ(base_color_at(s, 1, {0.375, 0.5}), Color(1, 0, 0));
  EXPECT_EQ(base_color_at(s, 2, {0.25, 0.5}), Color(1, 0, 0));
  EXPECT_EQ(base_color_at(s, 2, {1.25, 0.5}), Color(1, 0, 0)) << "repeated";
  EXPECT_EQ(base_color_at(s, 3, {1.25, 0.5}), Color(0, 1, 0))
      << "its edge goes on; black times a map is the map";
}

TEST(MtlLoader, NamesThatBeginAsNumbersDoAreNames) {
  write_two_colours("2nd.png");
  const SceneDescription scene =
      load_mesh("mtllib mesh.mtl\nusemtl a\n" + kTriangle + kFace, "newmtl a\nmap_Kd -s 2 3 2nd.png\n");
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.principled.at(0)[PrincipledInput::base_color].u_row, Vec3(2, 0, 0));
  EXPECT_EQ(scene.principled.at(0)[PrincipledInput::base_color].v_row, Vec3(0, 3, 0));
}

SceneDescription material_scene(const std::string& mtl) {
  return load_mesh("mtllib mesh.mtl\nusemtl a\n" + kTriangle + kFace, "newmtl a\n" + mtl);
}

TEST(MtlLoader, PlainMaterialsAreTheSameToAllModels) {
  const SceneDescription matt = material_scene("Kd 0.1 0.2 0.3\nKs 0 0 0\nNs 10\nillum 2\n");
  EXPECT_EQ(matt.materials[1].kind, MaterialKind::classical);
  EXPECT_EQ(matt.materials[1].color, Color(glm::vec3(0.1f, 0.2f, 0.3f)));
  EXPECT_EQ(matt.materials[1].diffuse, 1);
  EXPECT_EQ(matt.materials[1].specular, 0);
  expect_note(material_scene("Kd 1 1 1\nKs 1 1 1\nillum 1\n"), "mesh.mtl:1:", "`illum` 1 has no highlights");
}

TEST(MtlLoader, HighlightsAreMtlsOwnInClassicalModelsAndFacetsInPath) {
  const SceneDescription scene = material_scene("Kd 0.5 0.5 0.5\nKs 0.5 0.25 0.75\nNs 30\n");
  const MaterialDescription& m = scene.materials[1];
  EXPECT_EQ(m.kind, MaterialKind::principled);
  EXPECT_EQ(m.diffuse, 1);
  EXPECT_EQ(m.specular, 0.5) << "the mean";
  EXPECT_EQ(m.shininess, 30);
  EXPECT_EQ(m.reflect, 0);
  const PrincipledMaterial& p = scene.principled.at(0);
  EXPECT_EQ(p.has_coefficients, 1u);
  EXPECT_EQ(p[PrincipledInput::specular_color].factor, Color(1, 0.5, 1.5)) << "0.5 is what glass reflects";
  EXPECT_NEAR(p[PrincipledInput::roughness].factor.x, 0.5, 1e-12) << "alpha² = 2 / (30 + 2) = 1/16";
  const CompiledScene compiled = compile(scene);
  EXPECT_EQ(compiled.scene.materials[1].specular, 0.5);
}

TEST(MtlLoader, PhysicalKeysMakeAPrincipledMaterial) {
  write_two_colours("two.png");
  const SceneDescription scene = material_scene(
      "Kd 0.5 0.25 1\nPm 0.75\nPr 0.5\nmap_Pr -imfchan g two.png\nPc 1\nPcr 0.125\nNi 2\nKs 0.5 0.5 0.5\nKe "
      "0 0 1\n");
  const MaterialDescription& m = scene.materials[1];
  const PrincipledMaterial& p = scene.principled.at(m.principled);
  EXPECT_EQ(m.color, Color(0.5, 0.25, 1));
  EXPECT_EQ(m.emission, Color(0, 0, 1));
  EXPECT_EQ(p[PrincipledInput::metallic].factor.x, 0.75);
  EXPECT_EQ(p[PrincipledInput::roughness].factor.x, 0.5);
  EXPECT_EQ(p[PrincipledInput::roughness].channel, TextureChannel::green);
  EXPECT_FALSE(scene.textures.at(p[PrincipledInput::roughness].texture).is_from_srgb);
  EXPECT_EQ(p[PrincipledInput::clearcoat].factor.x, 1);
  EXPECT_EQ(p[PrincipledInput::clearcoat_roughness].factor.x, 0.125);
  EXPECT_EQ(p[PrincipledInput::specular_color].factor, Color(1));
  EXPECT_EQ(p.ior, 2);
  EXPECT_EQ(p.has_coefficients, 0u);
  EXPECT_EQ(notes_of(scene), "");
}

TEST(MtlLoader, WhatIsDissolvedIsThereInPartAndGlassLetsLightThrough) {
  const SceneDescription thin = material_scene("Kd 1 1 1\nTr 0.75\n");
  EXPECT_EQ(thin.materials[1].is_pierced, 1);
  EXPECT_EQ(thin.principled.at(0)[PrincipledInput::opacity].factor.x, 0.25);
  const SceneDescription glass = material_scene("Kd 0 0 0\nd 0.25\nNi 1.5\nTf 1 0.5 1\nillum 7\n");
  const MaterialDescription& m = glass.materials[1];
  EXPECT_EQ(m.is_pierced, 0);
  EXPECT_EQ(m.is_solid, 1);
  EXPECT_EQ(m.index, 1.5);
  EXPECT_EQ(m.transmit, 0.75);
  EXPECT_EQ(m.color, Color(0.75, 0.375, 0.75)) << "of Kd a quarter, of Tf the rest";
  EXPECT_EQ(glass.principled.at(0)[PrincipledInput::transmission].factor.x, 0.75);
  EXPECT_EQ(material_scene("Kd 0 0 0\nd 0\nNi 1.5\nillum 4\n").materials[1].is_solid, 0) << "glass, not bent";
  expect_note(material_scene("Kd 1 1 1\nd 0\n"), "mesh.mtl:1:", "is not seen");
}

TEST(MtlLoader, OpacityIsAnImagesAlphaWhereItHasOne) {
  write_two_colours("two.png");
  const SceneDescription grey = material_scene("Kd 1 1 1\nmap_d two.png\n");
  EXPECT_EQ(grey.principled.at(0)[PrincipledInput::opacity].channel, TextureChannel::luminance);
  EXPECT_EQ(grey.materials[1].is_pierced, 1);
  ASSERT_EQ(grey.textures.size(), 1u);
  EXPECT_EQ(half_of_float(1), grey.textures[0].texels[0]) << "its red, as it stands";
}

/// A ramp that rises along u by the whole width, and one of upright normals.
TEST(MtlLoader, BumpsAreHeightsOrNormals) {
  Image ramp{64, 4, {0, 0, 64, 4}, make_pixel_layout(PixelFormat::rgb8), {}}, flat = ramp;
  for (int i = 0; i < 64 * 4; ++i)
    for (int c = 0; c < 3; ++c) {
      ramp.pixels.push_back(static_cast<std::byte>(4 * (i % 64)));
      flat.pixels.push_back(static_cast<std::byte>(c == 2 ? 255 : 128));
    }
  write_image(write_temporary("ramp.png", ""), ramp, {});
  write_image(write_temporary("flat.png", ""), flat, {});
  const SceneDescription scene = material_scene(
      "Kd 1 1 1\nmap_Bump -bm 2 ramp.png\nnewmtl b\nKd 1 1 1\nbump flat.png -bm 0.5\nnewmtl c\nKd 1 1 "
      "1\nnorm flat.png\n");
  EXPECT_EQ(notes_of(scene), "");
  const auto normal = [&](size_t material) {
    const PrincipledSource& source = scene.principled.at(material)[PrincipledInput::normal];
    const TextureDescription& t = scene.textures.at(source.texture);
    const size_t texel = 64 + 32;
    Vec3 n(0);
    for (int c = 0; c < 3; ++c) n[c] = 2 * float_of_half(t.texels[3 * texel + static_cast<size_t>(c)]) - 1;
    return std::pair(n, source.factor.x);
  };
  const auto [bump, twice] = normal(0);
  // 4/255 a texel is 64 · 4/255 a width; white is a hundredth of it high.
  EXPECT_NEAR(bump.x / bump.z, -0.01 * 64 * 4 / 255, 1e-3);
  EXPECT_NEAR(bump.y, 0, 1e-3);
  EXPECT_EQ(twice, 2);
  const auto [upright, half] = normal(1);
  EXPECT_NEAR(upright.z, 1, 1e-6) << "taken as they are";
  EXPECT_EQ(half, 0.5);
  EXPECT_NEAR(normal(2).first.x, 128 / 127.5 - 1, 1e-3);
}

TEST(MtlLoader, FilesOfOtherMachinesAreFoundBesideTheLibrary) {
  write_two_colours("two.png");
  const SceneDescription scene = material_scene("Kd 1 1 1\nmap_Kd C:\\maps\\wood\\two.png\n");
  expect_note(scene, "mesh.mtl:3:8:", "the one beside the library stands for it");
  EXPECT_EQ(scene.textures.size(), 1u);
}

TEST(MtlLoader, ImagesOfTheSameNameAreThoseBesideTheirLibraries) {
  const auto folder = std::filesystem::path(write_temporary("mesh.mtl", "")).parent_path();
  for (const auto& [name, red] : {std::pair{"one", 255}, {"two", 0}}) {
    std::filesystem::create_directories(folder / name);
    std::ofstream(folder / name / "mesh.obj") << "mtllib mesh.mtl\nusemtl a\n" << kTriangle << kFace;
    std::ofstream(folder / name / "mesh.mtl") << "newmtl a\nmap_Kd wood.png\n";
    Image image{1, 1, {0, 0, 1, 1}, make_pixel_layout(PixelFormat::rgb8), std::vector<std::byte>(3)};
    image.pixels[0] = static_cast<std::byte>(red);
    write_image((folder / name / "wood.png").string(), image, {});
  }
  // The scene's own texture has the name of a file, and a third mesh comes to one of the two by another way.
  std::ofstream(folder / "mesh.obj") << "mtllib two/mesh.mtl one/../two/again.mtl\nusemtl b\n"
                                     << kTriangle << kFace;
  std::ofstream(folder / "two" / "again.mtl") << "newmtl b\nmap_Kd ../one/../two/wood.png\n";
  const SceneDescription scene =
      test::load_yaml(test::view_text() + fmt::format(R"(
textures: {{{}: {{kind: checker}}}}
scene: [{{mesh: {{file: one/mesh.obj}}}}, {{mesh: {{file: two/mesh.obj}}}}, {{mesh: {{file: mesh.obj}}}}]
)",
                                                      (folder / "one/wood.png").string()));
  const auto red_of = [&](const char* material) {
    std::vector<uint16_t> reds;
    for (const MaterialDescription& m : scene.materials)
      if (m.name == material) reds.push_back(scene.textures.at(m.texture).texels.at(0));
    return reds;
  };
  EXPECT_EQ(red_of("a"), (std::vector<uint16_t>{0x3c00, 0, 0}));
  EXPECT_EQ(red_of("b"), (std::vector<uint16_t>{0}));
  EXPECT_EQ(scene.textures.size(), 3u) << "each file is read once";
}

TEST(MtlLoader, WrongMapsEndInAnErrorAtTheirPlace) {
  const auto expect = [](const std::string& mtl, const std::string& place, const std::string& problem) {
    const std::string error = error_of_mesh("mtllib mesh.mtl\n" + kTriangle + kFace, mtl);
    EXPECT_NE(error.find(place), std::string::npos) << mtl << error;
    EXPECT_NE(error.find(problem), std::string::npos) << error;
  };
  expect("newmtl a\nmap_Kd -s 2 2 2 none.png\n", "mesh.mtl:2:17:", "none.png: no such file");
  expect("newmtl a\nmap_Kd -s 0 1 1 none.png\n", "mesh.mtl:2:", "must not be 0");
  expect("newmtl a\nmap_Kd -z 1 none.png\n", "mesh.mtl:2:8:", "unknown option '-z'");
  expect("newmtl a\nmap_Kd\n", "mesh.mtl:2:", "names no file");
  expect("newmtl a\nKd 1 x 0\n", "mesh.mtl:2:6:", "found 'x'");
  expect("newmtl a\nKd spectral a.rfl\n", "mesh.mtl:2:4:", "spectral");
  expect("newmtl a\nNs -1\n", "mesh.mtl:2:4:", "0 or more");
  expect("newmtl a\nmap_Pr -imfchan x none.png\n", "mesh.mtl:2:17:", "-imfchan");
  expect("newmtl a\nmap_d none.png\n", "mesh.mtl:2:7:", "none.png: no such file");
  expect("newmtl a\nmap_Bump none.png -bm 1\n", "mesh.mtl:2:10:", "none.png: no such file");
}

TEST(MtlLoader, WhatIsNotUsedIsNotedOnce) {
  const SceneDescription scene = load_mesh("mtllib mesh.mtl\n" + kTriangle + kFace,
                                           "Kd 1 1 1\n"            // 1
                                           "newmtl a\n"            // 2
                                           "Kd 1 1 1\n"            // 3
                                           "Ka 1 1 1\n"            // 4
                                           "disp b.png\n"          // 5
                                           "Ps 0.5\n"              // 6
                                           "Kdd 1 1 1\n"           // 7
                                           "d 0.5\n"               // 8
                                           "Ke 0 0 0\nTf 1 1 1\n"  // 9, 10
                                           "newmtl b\n"            // 11
                                           "Kd 1 1 1\n"            // 12
                                           "Ka 1 1 1\n"            // 13
                                           "d 0.5\nTr 0.4\n"       // 14, 15
                                           "illum 7\n"             // 16
                                           "Ks 1 0.5 0\n"          // 17
                                           "map_Ns b.png\n"        // 18
                                           "newmtl a\n"            // 19
                                           "newmtl black\n"        // 20
                                           "illum 10\n");          // 21
  expect_note(scene, "mesh.mtl:1:", "before the first `newmtl`");
  expect_note(scene, "mesh.mtl:4:", "`Ka` is not used");
  expect_note(scene, "mesh.mtl:5:", "`disp` is not used");
  expect_note(scene, "mesh.mtl:6:", "`Ps` is not used");
  expect_note(scene, "mesh.mtl:7:", "did you mean 'Kd'?");
  expect_note(scene, "mesh.mtl:11:", "`Tr` 0.4 of material 'b' is not used");
  expect_note(scene, "mesh.mtl:18:", "`map_Ns` is not used");
  expect_note(scene, "mesh.mtl:19:", "material 'a' is defined twice");
  expect_note(scene, "mesh.mtl:20:", "has no `Kd`");
  expect_note(scene, "mesh.mtl:20:", "`illum` 10");
  EXPECT_EQ(notes_of(scene).find("mesh.mtl:13:"), std::string::npos);
  EXPECT_EQ(notes_of(scene).find("`Ke` is"), std::string::npos);
  EXPECT_EQ(notes_of(scene).find("`Tf`"), std::string::npos);
}

TEST(MtlLoader, WhatShinesIsALight) {
  const CompiledScene compiled = compile(load_mesh("mtllib mesh.mtl\nusemtl lamp\n" + kTriangle + kFace,
                                                   "newmtl lamp\nKd 0.5 0.5 0.5\nKe 3 2 1\n"));
  ASSERT_EQ(compiled.scene.lights.size(), 1u);
  EXPECT_EQ(compiled.scene.lights[0].kind, LightKind::luminaire);
  EXPECT_EQ(compiled.scene.materials[compiled.scene.lights[0].material].emission, Color(3, 2, 1));
}

}  // namespace
}  // namespace rayfarm
