// Damaged and hostile glTF files: each ends in an error that says where and what.
#include <chrono>

#include "tests/unit/tiny_gltf.h"

namespace rayfarm {
namespace {

using test::shows;
using test::TinyGltf;

void expect_in(const std::string& message, const std::string& words) {
  EXPECT_NE(message.find(words), std::string::npos) << "'" << message << "' lacks '" << words << "'";
}

std::string error_of_text(const std::string& text, const char* name = "damaged.gltf") {
  return test::error_of(text, name);
}

TEST(GltfDamage, FilesThatAreNone) {
  expect_in(error_of_text(""), "the file is empty");
  expect_in(error_of_text("", "damaged.glb"), "the file is empty");
  expect_in(error_of_text("  \n"), "nothing but blanks");
  expect_in(error_of_text("gl", "damaged.glb"), "too short for a binary glTF");
  expect_in(error_of_text(std::string("\xff\xfe{\0}\0", 6)), "the file is in UTF-16; save it as UTF-8");
  expect_in(error_of_text("{\"asset\": "), "not valid JSON");
  expect_in(error_of_text("[]"), "an object, {…}, was expected");
  expect_in(error_of_text("{}"), "`asset` is missing");
  expect_in(error_of_text(R"({"asset": {"version": "1.0"}})"), "it is of glTF 1.0");
  expect_in(error_of_text(R"({"asset": {"version": "2.0", "minVersion": "2.1"}})"),
            "its asset.minVersion asks for a reader of glTF 2.1");
  expect_in(error_of_text(std::string(1'000'000, '[')), "nested more than 128 deep");
  expect_in(error_of_text("glTF", "damaged.glb"), "ends before its first chunk");
  TinyGltf file;
  file.write_glb(shows(fmt::format(R"("attributes": {{"POSITION": {}}})", file.square())));
  std::ifstream in(file.write_glb(shows(fmt::format(R"("attributes": {{"POSITION": {}}})", 0))),
                   std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  ASSERT_EQ(error_of_text(whole, "damaged.glb"), "");
  for (size_t size = 0; size < whole.size(); size += 7)
    EXPECT_NE(error_of_text(whole.substr(0, size), "damaged.glb"), "") << size;
  std::string other = whole;
  other[4] = 1;
  expect_in(error_of_text(other, "damaged.glb"), "of version 1");
  other = whole;
  other[12] = '\x7f';
  expect_in(error_of_text(other, "damaged.glb"), "a chunk is longer than the file");
}

TEST(GltfDamage, BytesThatAreNotThere) {
  TinyGltf file;
  const size_t p = file.square();
  const auto with = [&](const std::string& accessor) {
    TinyGltf damaged;
    damaged.square();
    damaged.accessor(5126, "VEC3", 4, accessor);
    return damaged.error(shows(R"("attributes": {"POSITION": 1}, "mode": 6)"));
  };
  (void)p;
  EXPECT_EQ(with(R"("bufferView": 0)"), "");
  expect_in(with(R"("bufferView": 0, "byteOffset": 4)"),
            "accessors[1]: its 4 elements are not all in its bufferView");
  expect_in(with(R"("bufferView": 0, "byteOffset": 18446744073709551615)"), "not all in its bufferView");
  expect_in(with(R"("bufferView": 7)"), "accessors[1].bufferView: 7 does not exist: the file has 1");
  expect_in(with(R"("bufferView": -1)"), "a whole number from 0 on was expected");
  expect_in(with(R"("bufferView": 0.5)"), "a whole number from 0 on was expected");
  expect_in(with(R"("bufferView": "0")"), "a number was expected");
  expect_in(with(R"("sparse": {"count": 5, "indices": {}, "values": {}})"),
            "replaces more elements than there are");
  const auto accessor = [&](const std::string& text) {
    return test::error_of(
        R"({"asset": {"version": "2.0"}, "accessors": [{)" + text +
            R"(}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})",
        "damaged.gltf");
  };
  expect_in(accessor(R"("componentType": 5126, "type": "VEC3", "count": 1000000000)"), "said to be zero");
  expect_in(accessor(R"("componentType": 5126, "type": "VEC3", "count": 99999999999)"), "a number from 1 to");
  expect_in(accessor(R"("componentType": 5126, "type": "VEC3", "count": 1e300)"), "a whole number");
  expect_in(accessor(R"("componentType": 5126, "type": "VEC5", "count": 3)"), "'VEC5' is not read here");
  expect_in(accessor(R"("componentType": 9, "type": "VEC3", "count": 3)"), "9 is no type of components");
  expect_in(accessor(R"("componentType": 5126, "type": "VEC2", "count": 3)"),
            "2 components, which don't fit");
  expect_in(test::error_of(
                R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 9, "uri": "data:a;base64,AAAA"}],
      "bufferViews": [{"buffer": 0, "byteLength": 1}], "accessors": [{"componentType": 5126, "type": "VEC3",
      "count": 3, "bufferView": 0}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})",
                "damaged.gltf"),
            "of its 9 bytes 3 are there");
}

TEST(GltfDamage, SparseIndicesRise) {
  for (const auto& [indices, is_good] :
       {std::pair{std::vector<uint16_t>{1, 3}, true}, {{3, 1}, false}, {{1, 1}, false}, {{1, 4}, false}}) {
    TinyGltf file;
    file.square();
    const size_t i = file.view(indices), v = file.view(std::vector<float>{1, 0, 0, 0, 1, 0});
    const size_t p = file.accessor(5126, "VEC3", 4,
                                   fmt::format(R"("bufferView": 0, "sparse": {{"count": 2,
        "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}})",
                                               i, v));
    EXPECT_EQ(file.error(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 6)", p))).empty(),
              is_good);
  }
}

TEST(GltfDamage, IndicesAndNumbersOfMeshes) {
  TinyGltf file;
  const size_t p = file.square(), i = file.indices<uint16_t>({0, 1, 4}), few = file.vectors({0, 0, 1});
  expect_in(file.error(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {})", p, i))),
            "meshes[0].primitives[0].indices: its 3. index is 4, but there are 4 vertices");
  expect_in(file.error(shows(fmt::format(R"("attributes": {{"POSITION": {0}}}, "indices": {0})", p))),
            "3 components, which don't fit");
  expect_in(file.error(shows(fmt::format(R"("attributes": {{"POSITION": {}, "NORMAL": {}}})", p, few))),
            "it has 1 elements, but the primitive has 4 vertices");
  expect_in(file.error(shows(fmt::format(R"("attributes": {{"POSITION": {}}}, "mode": 7)", p))),
            "a mode from 0 to 6");
  TinyGltf bad;
  const size_t n = bad.vectors({0, 0, 0, 1, 0, 0, 1, NAN, 0});
  expect_in(bad.error(shows(fmt::format(R"("attributes": {{"POSITION": {}}})", n))),
            "vertex 2 has coordinates that are no");
}

TEST(GltfDamage, NodesThatAreNoTree) {
  TinyGltf file;
  const std::string mesh =
      fmt::format(R"("meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}], )", file.square());
  expect_in(file.error(mesh + R"("nodes": [{"children": [0]}])"), "it contains itself");
  expect_in(file.error(mesh + R"("nodes": [{"children": [1]}, {"children": [2]}, {"children": [0]}])"),
            "it contains itself");
  expect_in(file.error(mesh + R"("nodes": [{"children": [1, 1]}, {"mesh": 0}])"), "a node has one parent");
  expect_in(file.error(mesh + R"("nodes": [{"children": [1]}, {"mesh": 0}], "scenes": [{"nodes": [1]}])"),
            "and no root");
  expect_in(file.error(mesh + R"("nodes": [{"mesh": 0}], "scenes": [{"nodes": [0, 0]}])"), "twice");
  expect_in(file.error(mesh + R"("nodes": [{"children": [9]}])"), "there is no such node");
  expect_in(file.error(mesh + R"("nodes": [{"mesh": 3}])"),
            "nodes[0].mesh: 3 does not exist: the file has 1");
  // Each node holds the one before twice: 2^48 instances.
  std::string nodes = R"({"mesh": 0})";
  for (int i = 0; i < 48; ++i) nodes += fmt::format(R"(, {{"children": [{0}, {0}]}})", i);
  expect_in(file.error(mesh + fmt::format(R"("nodes": [{}])", nodes)), "a node has one parent");
}

TEST(GltfDamage, ChainsOfNodesEnd) {
  TinyGltf file;
  std::string nodes = R"({"mesh": 0})";
  for (int i = 0; i < 200'000; ++i) nodes += fmt::format(R"(,{{"children":[{}]}})", i);
  const std::string rest =
      fmt::format(R"("meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}], "nodes": [{}])",
                  file.square(), nodes);
  const auto begin = std::chrono::steady_clock::now();
  expect_in(file.error(rest), "nodes are nested more than 900 deep");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(GltfDamage, TheSameFacesOverAndOver) {
  TinyGltf file;
  std::vector<uint16_t> indices;
  for (int i = 0; i < 30'000; ++i) indices.push_back(static_cast<uint16_t>(i % 3));
  const size_t p = file.square(), i = file.indices(indices);
  std::string primitives;
  for (int k = 0; k < 1000; ++k)
    primitives += fmt::format(R"({}{{"attributes": {{"POSITION": {}}}, "indices": {}}})", k ? "," : "", p, i);
  expect_in(
      file.error(fmt::format(R"("nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{}]}}])", primitives)),
      "use the same data over and over");
}

TEST(GltfDamage, ExtensionsAreNamed) {
  TinyGltf file;
  const std::string mesh = shows(fmt::format(R"("attributes": {{"POSITION": {}}})", file.square()));
  expect_in(file.error(mesh + R"(, "extensionsUsed": ["EXT_new"], "extensionsRequired": ["EXT_new"])"),
            "it requires the extension EXT_new");
  const CompiledScene compiled =
      compile(file.load(mesh + R"(, "extensionsUsed": ["EXT_new", "KHR_materials_ior"])"));
  expect_in(test::notes_of(compiled), "not used: the extension EXT_new\n");
  expect_in(file.error(mesh + R"(, "extensionsRequired": ["KHR_draco_mesh_compression"])"),
            "KHR_draco_mesh_compression");
}

TEST(GltfDamage, FilesOfTheSharedAssetsAreRefused) {
  const auto folder = std::filesystem::path(RAYFARM_SOURCE) / "../shared/assets/broken";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "shared/assets/broken is not there";
  for (const auto& [name, words] : {std::pair{"IndexOutOfRange.gltf", "its 1. index is 255"},
                                    {"RecursiveNodes.gltf", "contains itself"},
                                    {"chunk_too_big.glb", "no room for a chunk"},
                                    {"invalid_json_chunk.glb", "not valid JSON"}})
    try {
      compile(load_scene((folder / name).string()));
      ADD_FAILURE() << name;
    } catch (const InputError& e) {
      expect_in(e.what(), words);
    }
}

}  // namespace
}  // namespace rayfarm
