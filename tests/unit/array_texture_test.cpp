// Arrays of values in space (thesis 2.3.6: "The function used for mapping can be analytical [...] or an array
// of data values."; "A three dimensional map is used for this purpose."), and the files that hold them.
#include <cstring>

#include "common/description/formats/npy_loader.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

SceneDescription load_array(const std::string& keys) {
  return test::load_yaml(test::view_text() + "textures: {t: {kind: array, " + keys + "}}\nscene: []\n");
}

Color eval(const SceneDescription& scene, const Vec3& p, double width = 0) {
  return eval_texture(scene.textures[0], scene.textures[0].texels, {p, {}, width, 0});
}

TEST(Arrays, AreLinearBetweenTheMiddlesOfTheirCells) {
  // x + 10 y + 100 z, over 200: linear itself, so what is between is exact.
  const SceneDescription scene = load_array(
      "size: [3, 2, 2], values: [0, 0.005, 0.01, 0.05, 0.055, 0.06, 0.5, 0.505, 0.51, 0.55, 0.555, 0.56], "
      "scale: 2, from: [1, 0, 0]");
  const auto expected = [](double x, double y, double z) { return (x + 10 * y + 100 * z) / 200; };
  const auto at = [](double x, double y, double z) {
    return Vec3(2 * x + 2, 2 * y + 1, 2 * z + 1);
  };  // of a middle
  for (const Vec3& cell :
       {Vec3(0, 0, 0), Vec3(2, 1, 1), Vec3(0.5, 0, 0), Vec3(0.25, 0.75, 0.5), Vec3(1.9, 0.1, 0.3)})
    EXPECT_NEAR(eval(scene, at(cell.x, cell.y, cell.z)).x, expected(cell.x, cell.y, cell.z), 3e-4);
  // Repeated: one cell beyond the last is the first.
  EXPECT_NEAR(eval(scene, at(3, 0, 0)).x, 0, 3e-4);
  EXPECT_NEAR(eval(scene, at(-1, 0, 0)).x, 0.01, 3e-4);
}

TEST(Arrays, MayGoOnWithTheirOutermostValues) {
  const SceneDescription scene = load_array("size: [2, 1, 1], values: [0.25, 0.75], repeat: false");
  EXPECT_EQ(eval(scene, Vec3(-7, 3, 3)).x, 0.25);
  EXPECT_EQ(eval(scene, Vec3(70, 3, -3)).x, 0.75);
  EXPECT_EQ(eval(scene, Vec3(1, 0, 0)).x, 0.5);
}

TEST(Arrays, FromAfarAreTheirMean) {
  const SceneDescription scene = load_array("size: [2, 2, 2], values: [0, 1, 0, 1, 0, 1, 1, 1]");
  EXPECT_NEAR(eval(scene, Vec3(0.3, 0.2, 0.9), 100).x, 5.0 / 8, 1e-3);
}

// "If the map has color information then there is one set of mapping values for each of the three primary
// colors."
TEST(Arrays, HoldValuesOrColours) {
  const SceneDescription grey =
      load_array("size: [2, 1, 1], values: [0, 1], first: [1, 0, 0], second: [0, 0, 1]");
  EXPECT_EQ(eval(grey, Vec3(0.5, 0, 0)), Color(1, 0, 0));
  EXPECT_EQ(eval(grey, Vec3(1.5, 0, 0)), Color(0, 0, 1));
  const SceneDescription colour = load_array("size: [2, 1, 1], values: [1, 0.5, 0, 0, 0.25, 1]");
  EXPECT_EQ(eval(colour, Vec3(0.5, 0, 0)), Color(1, 0.5, 0));
  EXPECT_EQ(eval(colour, Vec3(1.5, 0, 0)), Color(0, 0.25, 1));
}

TEST(Arrays, ErrorsHaveTheirPlace) {
  const auto expect_says = [](const std::string& keys, const char* what) {
    const std::string message =
        test::error_of(test::view_text() + "textures: {t: {kind: array, " + keys + "}}\nscene: []\n");
    EXPECT_NE(message.find(what), std::string::npos) << message;
    EXPECT_NE(message.find("scene.yaml:2:"), std::string::npos) << message;
  };
  expect_says("size: [2, 2, 1], values: [0, 1]", "needs 4 values");
  expect_says("size: [2, 1, 1], values: [0, 2]", "from 0 to 1");
  expect_says("size: [2, 1], values: [0, 1]", "[x, y, z]");
  expect_says("size: [0, 1, 1], values: [0, 1]", "from 1 to");
  expect_says("size: [1000000, 1000000, 1000000], values: [0, 1]", "more cells than there is room for");
  expect_says("values: [0, 1]", "needs the key 'size'");
  expect_says("file: none.npy", "none.npy");
  expect_says("file: none.npy, size: [1, 1, 1]", "not both");
  expect_says("size: [1, 1, 1], values: [0], octaves: 3", "unknown key 'octaves'");
}

/// A file as numpy.save writes it.
std::string npy(const std::string& type, const char* order, const std::string& shape,
                const std::string& data) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header + data;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

ArrayValues load(const std::string& bytes) {
  return load_npy(test::write_temporary("a.npy", bytes), limits::kArrayCells);
}

TEST(NpyFiles, AxesAreXyzInEitherOrder) {
  // a[x, y, z] of shape (1, 2, 3): 0 1 2 / 3 4 5, over 8. Here x is fastest, then y.
  const std::vector<float> last_fastest{0, 0.125F, 0.25F, 0.375F, 0.5F, 0.625F},
      first_fastest{0, 0.375F, 0.125F, 0.5F, 0.25F, 0.625F};
  for (const ArrayValues& a : {load(npy("<f4", "False", "(1, 2, 3)", bytes_of(last_fastest))),
                               load(npy("<f4", "True", "(1, 2, 3)", bytes_of(first_fastest)))}) {
    EXPECT_EQ(a.size, (std::array<uint32_t, 3>{1, 2, 3}));
    EXPECT_EQ(a.channels, 1u);
    EXPECT_EQ(a.values, first_fastest);
  }
  const ArrayValues colours =
      load(npy("|u1", "False", "(2, 1, 1, 3)", bytes_of(std::vector<uint8_t>{255, 0, 51, 0, 255, 0})));
  EXPECT_EQ(colours.channels, 3u);
  EXPECT_EQ(colours.values, (std::vector<float>{1, 0, 0.2F, 0, 1, 0}));
  EXPECT_EQ(load(npy("<f8", "False", "(2, 1)", bytes_of(std::vector<double>{0.5, 1}))).values,
            (std::vector<float>{0.5F, 1}));
  EXPECT_EQ(load(npy("<u2", "False", "(1, 1, 1)", bytes_of(std::vector<uint16_t>{65535}))).values[0], 1);
  EXPECT_EQ(load(npy("<f2", "False", "(1, 1, 1)", bytes_of(std::vector<uint16_t>{0x3800}))).values[0], 0.5F);
}

TEST(NpyFiles, DamageEndsInAnError) {
  const std::string whole = npy("<f4", "False", "(1, 2, 3)", bytes_of(std::vector<float>(6, 0.5F)));
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(load(whole.substr(0, size)), InputError) << size;
  const auto expect_says = [](const std::string& bytes, const char* what) {
    try {
      load(bytes);
      FAIL() << what;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  };
  const std::string six = bytes_of(std::vector<float>(6, 0.5F));
  expect_says("no array", "numpy.save");
  expect_says(npy(">f4", "False", "(1, 2, 3)", six), "'>f4'");
  expect_says(npy("<f4", "False", "(6,)", six), "two or three axes");
  expect_says(npy("<f4", "False", "(1, 1, 2, 3, 1)", six), "two or three axes");
  expect_says(npy("<f4", "False", "(0, 2, 3)", ""), "empty");
  expect_says(npy("<f4", "False", "(1, 2, 4)", six), "32 bytes");
  expect_says(npy("<f4", "False", "(4294967296, 4294967296, 1)", six), "more cells");
  expect_says(npy("<f4", "False", "(18446744073709551617, 1)", six), "no shape");
  expect_says(npy("<f4", "False", "(1, 2, 3)", bytes_of(std::vector<float>{0, 0, 0, 0, 1.5F, 0})),
              "[0, 1, 1] is 1.5");
  expect_says(npy("<f4", "False", "(1, 2, 3)", bytes_of(std::vector<float>{0, 0, NAN, 0, 0, 0})),
              "[0, 0, 2] is nan");
}

TEST(NpyFiles, ScenesNameThem) {
  const std::string path = test::write_temporary(
      "cube.npy", npy("<f4", "False", "(1, 2, 3)", bytes_of(std::vector<float>(6, 0.5F))));
  const SceneDescription scene = load_array("file: cube.npy");
  EXPECT_EQ(scene.files.back(), path);
  EXPECT_EQ(eval(scene, Vec3(0.1, 0.2, 0.3)).x, 0.5);
}

}  // namespace
}  // namespace rayfarm
