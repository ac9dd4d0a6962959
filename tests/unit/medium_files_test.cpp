// Media in scene files: what they say, and what is wrong with them, each with its place.
#include "tests/unit/damaged_scene.h"

namespace rayfarm {
namespace {

std::string with_media(const std::string& media) {
  return test::view_text() + "media:\n" + media + "scene: []\n";
}
std::string with_grid(const std::string& grid) {
  return with_media("  - {box: {min: [0, 0, 0], max: [2, 1, 1]}, scattering: 1, grid: {" + grid + "}}\n");
}
void expect_file_error(const std::string& text, const std::string& place, const std::string& problem) {
  const std::string error = test::error_of(text);
  EXPECT_NE(error.find(place), std::string::npos) << error;
  EXPECT_NE(error.find(problem), std::string::npos) << error;
}

TEST(MediumFiles, AreReadAsTheyAreWritten) {
  const SceneDescription scene = test::load_yaml(with_media(
      "  - {box: {min: [0, 1, 2], max: [3, 4, 5]}, absorption: [1, 2, 3], scattering: 0.5, g: -0.3}\n"
      "  - {box: {min: [3, 1, 2], max: [4, 4, 5]}, absorption: {spectrum: [[450, 1], [650, 3]]}}\n"));
  ASSERT_EQ(scene.media.size(), 2u) << "boxes that touch";
  EXPECT_EQ(scene.media[0].box.lo, Vec3(0, 1, 2));
  EXPECT_EQ(scene.media[0].box.hi, Vec3(3, 4, 5));
  EXPECT_EQ(scene.media[0].absorption, Color(1, 2, 3));
  EXPECT_EQ(scene.media[0].scattering, Color(0.5));
  EXPECT_EQ(scene.media[0].asymmetry, -0.3);
  // Red loses more than blue, and in a pass of other wavelengths the spectrum's own values hold.
  EXPECT_GT(scene.media[1].absorption.x, scene.media[1].absorption.z);
  ASSERT_EQ(scene.spectra.size(), 1u);
  EXPECT_EQ(scene.spectra[0].index, 1u);
}

TEST(MediumFiles, GridsOfAllTypesAndOrders) {
  // Six cells: whole numbers become 0 to 1, x is fastest.
  const std::string bytes8("\x00\xff\x33\x66\x99\xcc", 6),
      low16("\x00\x00\xff\xff\x33\x33\x66\x66\x99\x99\xcc\xcc", 12);
  const std::array<float, 6> values{0, 1, 0.2f, 0.4f, 0.6f, 0.8f};
  std::string floats(24, '\0'), swapped;
  std::memcpy(floats.data(), values.data(), 24);
  for (size_t i = 0; i < 24; i += 4) swapped += {floats[i + 3], floats[i + 2], floats[i + 1], floats[i]};
  const std::string nrrd =
      "NRRD0004\n# made\nkey:=value\ntype: float\ndimension: 3\nsizes: 3 2 1\nendian: little\nencoding: "
      "raw\n";
  test::write_temporary("a.raw", bytes8);
  test::write_temporary("b.raw", low16);
  test::write_temporary("c.raw", floats);
  test::write_temporary("d.raw", swapped);
  test::write_temporary("e.nrrd", nrrd + "\n" + floats);
  test::write_temporary("f.nhdr", nrrd + "data file: c.raw\n");
  for (const char* grid :
       {"file: a.raw, size: [3, 2, 1], type: uint8", "file: b.raw, size: [3, 2, 1], type: uint16",
        "file: c.raw, size: [3, 2, 1], type: float32",
        "file: d.raw, size: [3, 2, 1], type: float32, endian: big", "file: e.nrrd", "file: f.nhdr"}) {
    const SceneDescription scene = test::load_yaml(with_grid(grid));
    ASSERT_EQ(scene.media[0].densities.size(), 6u);
    for (size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(scene.media[0].densities[i], values[i]) << grid;
    EXPECT_TRUE(scene.notes.lines().empty()) << grid;
    EXPECT_EQ(scene.files.size(), grid == std::string("file: f.nhdr") ? 3u : 2u);
  }
  test::write_temporary("g.raw", std::string("\x01\x02", 2));
  EXPECT_FLOAT_EQ(test::load_yaml(with_grid("file: g.raw, size: [1, 1, 1], type: uint16, endian: big"))
                      .media[0]
                      .densities[0],
                  0x102 / 65535.0f);
  // What a header says of space is not used, and that is said.
  test::write_temporary(
      "h.nrrd",
      "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 3 2 1\nspacings: 1 1 2\nencoding: raw\n\n" + bytes8);
  const SceneDescription spaced = test::load_yaml(with_grid("file: h.nrrd"));
  ASSERT_EQ(spaced.notes.lines().size(), 1u);
  EXPECT_NE(spaced.notes.lines()[0].find("`spacings`"), std::string::npos) << spaced.notes.lines()[0];
}

TEST(MediumFiles, WhatIsWrongIsToldWithItsPlace) {
  const auto medium = [](const std::string& keys) {
    return with_media("  - {box: {min: [0, 0, 0], max: [2, 1, 1]}, " + keys + "}\n");
  };
  expect_file_error(medium("absorption: -1"), "scene.yaml:3:", "absorption");
  expect_file_error(medium("scattering: [1, 2, -0.1]"), "scene.yaml:3:", "scattering");
  expect_file_error(medium("scattering: .nan"), "scene.yaml:3:", "scattering");
  expect_file_error(medium("scattering: 1, g: 1"), "scene.yaml:3:", "0.99");
  expect_file_error(medium("absorption: 1, g: 0.3"), "scene.yaml:3:", "`scattering`");
  expect_file_error(medium("g: 0.3"), "scene.yaml:3:", "`scattering`");
  expect_file_error(medium("absorption: 0"), "scene.yaml:3:5", "above 0");
  expect_file_error(medium("absorption: 1e7"), "scene.yaml:3:5", "solid");
  expect_file_error(medium("absorbtion: 1"), "scene.yaml:3:", "did you mean 'absorption'");
  expect_file_error(with_media("  - {absorption: 1}\n"), "scene.yaml:3:5", "box");
  expect_file_error(with_media("  - {box: {min: [0, 0, 0], max: [0, 1, 1]}, absorption: 1}\n"),
                    "scene.yaml:3:", "below");
  expect_file_error(with_media("  - {box: {min: [0, 0, 0], max: [2, 1, 1]}, absorption: 1}\n"
                               "  - {box: {min: [1, 0, 0], max: [3, 1, 1]}, absorption: 1}\n"),
                    "scene.yaml:4:5",
                    "overlaps the one at " + test::write_temporary("scene.yaml", "") + ":3:5");
  std::string many;
  for (int i = 0; i < 65; ++i)
    many += fmt::format("  - {{box: {{min: [{}, 0, 0], max: [{}, 1, 1]}}, absorption: 1}}\n", i, i + 1);
  expect_file_error(with_media(many), "scene.yaml:67:", "no more than 64");
}

TEST(MediumFiles, WhatIsWrongWithGridsIsTold) {
  test::write_temporary("six.raw", "abcdef");
  const auto raw = [](const std::string& keys) { return with_grid("file: six.raw, " + keys); };
  expect_file_error(raw("size: [3, 3, 1], type: uint8"), "six.raw", "9 bytes, but 6 are there");
  expect_file_error(raw("size: [3, 2], type: uint8"), "scene.yaml:3:", "[x, y, z]");
  expect_file_error(raw("size: [0, 2, 1], type: uint8"), "scene.yaml:3:", "1");
  expect_file_error(raw("size: [100000, 100000, 100000], type: uint8"), "scene.yaml:3:", "room");
  expect_file_error(raw("size: [3, 2, 1], type: uint9"), "scene.yaml:3:", "uint8");
  expect_file_error(raw("size: [3, 2, 1]"), "scene.yaml:3:", "type");
  expect_file_error(with_grid("file: none.raw, size: [3, 2, 1], type: uint8"), "scene.yaml:3:", "none.raw");
  expect_file_error(with_grid("file: smoke.vdb"), "scene.yaml:3:", ".nrrd");
  const auto bad_float = [](float value) {
    std::string bytes(8, '\0');
    std::memcpy(bytes.data() + 4, &value, 4);
    test::write_temporary("bad.raw", bytes);
    return with_grid("file: bad.raw, size: [1, 2, 1], type: float32");
  };
  expect_file_error(bad_float(-0.5f), "bad.raw", "[0, 1, 0] is -0.5");
  expect_file_error(bad_float(std::numeric_limits<float>::quiet_NaN()), "bad.raw", "[0, 1, 0] is nan");
  expect_file_error(bad_float(std::numeric_limits<float>::infinity()), "bad.raw", "0 or more");
  expect_file_error(bad_float(1e30f), "scene.yaml:3:5", "solid");

  const auto nrrd = [](const std::string& header) {
    test::write_temporary("in.nrrd", header + "\n\n123456");
    return with_grid("file: in.nrrd");
  };
  expect_file_error(nrrd("P6"), "in.nrrd", "NRRD000");
  expect_file_error(nrrd("NRRD0004\ndimension: 4"), "in.nrrd:2", "three axes, not 4");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2"), "in.nrrd:3", "three whole numbers");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1 4"), "in.nrrd:3", "three whole numbers");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 99999 99999 99999"), "in.nrrd:3", "room");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1\ntype: block"), "in.nrrd:4", "block");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1\ntype: uchar\nencoding: gzip"), "in.nrrd:5",
                    "gzip");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1\ntype: float\nencoding: raw"), "in.nrrd",
                    "endian");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1\ntype: uchar\nencoding: raw\nbyte skip: 3"),
                    "in.nrrd:6", "byteskip");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 2\ntype: uchar\nencoding: raw"), "in.nrrd",
                    "12 bytes, but 6");
  expect_file_error(
      nrrd("NRRD0004\ndimension: 3\nsizes: 3 2 1\ntype: uchar\nencoding: raw\ndata file: gone.raw"),
      "in.nrrd:6", "gone.raw");
  expect_file_error(nrrd("NRRD0004\ndimension: 3\ndimension: 3"), "in.nrrd:3", "twice");
  expect_file_error(nrrd("NRRD0004\nhello"), "in.nrrd:2", "name: value");
  expect_file_error(with_grid("file: in.nrrd, type: uint8"), "scene.yaml:3:", "leave it out");
}

TEST(MediumFiles, DamagedBlocksAreRefused) {
  const CompiledScene compiled = test::compile_everything();
  ASSERT_EQ(compiled.scene.media.size(), 2u);
  const auto refuse = [&](const std::function<void(ParticipatingMedium&)>& damage, const char* what) {
    test::expect_refusal_at<ParticipatingMedium>(compiled, &Scene::media, damage, what);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refuse([](auto& m) { m.box.hi.x = m.box.lo.x; }, "an empty box");
  refuse([](auto& m) { m.box.lo.y = kNan; }, "no box");
  refuse([](auto& m) { m.absorption.y = -1; }, "negative absorption");
  refuse([](auto& m) { m.scattering.z = kNan; }, "no scattering");
  refuse([](auto& m) { m.scattering.z = 1e300; }, "steps without end");
  refuse([](auto& m) { m.asymmetry = 1; }, "an asymmetry of 1");
  refuse([](auto& m) { m.cells[1] = 0; }, "a grid without cells");
  refuse(
      [](auto& m) {
        m.cells[0] = 0x80000000;
        m.cells[1] = 2;
      },
      "cells beyond all numbers");
  refuse([](auto& m) { m.first_density = 1; }, "densities beyond the end");
  refuse([](auto& m) { m.first_majorant = 1; }, "majorants beyond the end");
  test::expect_refusal_at<float>(
      compiled, &Scene::medium_densities, [](float& d) { d = -1; }, "a negative density");
  test::expect_refusal_at<float>(
      compiled, &Scene::medium_majorants, [](float& d) { d = 1e30f; }, "a majorant too large");
}

TEST(MediumFiles, PartsLeaveMediaOut) {
  const SceneDescription scene =
      test::load_yaml(with_media("  - {box: {min: [0, 0, 0], max: [2, 1, 1]}, absorption: 1}\n"));
  const CompiledScene part = compile(scene, {}, Purpose::library);
  EXPECT_TRUE(part.scene.media.empty());
  EXPECT_NE(test::notes_of(part).find("`media`"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
