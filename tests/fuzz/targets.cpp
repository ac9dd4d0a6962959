#include "tests/fuzz/targets.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "common/compile/compile.h"
#include "common/description/formats/ies_loader.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/yaml_scene.h"
#include "common/description/part_file.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"
#include "common/scene/settings_codec.h"
#include "protocol/block_codec.h"
#include "protocol/job_plan.h"
#include "tests/fuzz/block_seeds.h"
#include "tests/fuzz/folder.h"
#include "tests/fuzz/gltf_seeds.h"
#include "tests/fuzz/grid_seeds.h"
#include "tests/fuzz/image_bytes.h"
#include "tests/fuzz/journal_bytes.h"
#include "tests/fuzz/mesh_seeds.h"
#include "tests/fuzz/messages.h"
#include "tests/fuzz/zone_bytes.h"
#include "tests/read_in_pieces.h"
#include "tests/render_little.h"
#include "tests/scene_text.h"

namespace rayfarm::fuzz {
namespace {

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

void render(const Scene& scene, int frame) {
  test::render_little(scene, frame, 4, 3);
}

void render_file(const std::string& path) {
  const SceneDescription scene = load_scene(path);
  const CompiledScene compiled = compile(scene);
  if (compiled.block.size < 1 << 22) render(compiled.scene, scene.frames ? (*scene.frames)[0] : 0);
}

std::vector<std::string> scene_seeds(const char* extension) {
  std::vector<std::string> seeds;
  for (const char* folder : {RAYFARM_SOURCE "/scenes", RAYFARM_SOURCE "/tests/golden/scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == extension && entry.file_size() < 20'000)
        seeds.push_back(read_file(entry.path(), limits::kFileBytes));
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

constexpr const char* kYamlPart =
    "view: {location: [0, 0, 9], look_at: [0, 0, 0]}\nlights: [{position: [1, 2, 3]}]\nscene:\n"
    "  - {use: {file: a.rfp}}\n  - {use: {file: a.rfp}, transform: {scale: 0.5}}\n";
constexpr const char* kNff =
    "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 8 8\nb 0.1 0.2 0.3\nl 3 4 5\n"
    "f 1 0.5 0.2 0.8 0.3 20 0 1\np 4\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\ns 0 0 1 0.5\nc\n0 0 0 1\n0 0 1 0.2\n"
    "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";

/// However it is cut, by lines or records or a few pieces, a file is what it is in one, and so is its error.
template <typename Read, typename IsSame>
void cut(const std::string& bytes, Read read, IsSame is_same) {
  std::vector<size_t> all(bytes.size());
  std::iota(all.begin(), all.end(), size_t{0});
  const std::vector<size_t> thirds{bytes.size() / 3, 2 * bytes.size() / 3};
  const auto whole = read(std::span<const size_t>());
  for (const std::vector<size_t>& borders : {all, thirds})
    if (!is_same(whole, read(std::span<const size_t>(borders))))
      throw std::logic_error("cut into pieces the file is another");
}
void cut_nff(const std::string& bytes) {
  cut(
      bytes, [&](std::span<const size_t> borders) { return test::read_nff(bytes, "in.nff", borders); },
      [](const auto& a, const auto& b) { return a == b; });
}
void cut_obj(const std::string& bytes, const std::string& path) {
  cut(
      bytes, [&](std::span<const size_t> borders) { return test::read_obj(bytes, path, borders); },
      [](const auto& a, const auto& b) { return test::is_same(a, b); });
}
void cut_ply(const std::string& bytes) {
  cut(
      bytes, [&](std::span<const size_t> borders) { return test::read_ply(bytes, "in.ply", borders); },
      [](const auto& a, const auto& b) { return test::is_same(a, b); });
}
void cut_stl(const std::string& bytes) {
  cut(
      bytes, [&](std::span<const size_t> borders) { return test::read_stl(bytes, "in.stl", borders); },
      [](const auto& a, const auto& b) { return test::is_same(a, b); });
}

/// With its lists of numbers read apart a file is what it is as a whole.
void read_yaml_both_ways(const std::string& bytes, const std::string& path) {
  try {
    const auto apart = read_yaml_outline(bytes, path, 0);
    if (apart && test::text_of_scene(*apart) != test::text_of_scene(read_yaml_whole(bytes, path)))
      throw std::logic_error("with its lists read apart the file is another");
  } catch (const InputError&) {
    throw std::logic_error("with its lists read apart the file has no error");
  }
}

constexpr const char* kIes =
    "IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n100 50 0\n";

Bytes zeros(size_t n) {
  return Bytes(n);
}

/// Stripes, steps and something like noise.
Bytes uneven(size_t n) {
  Bytes bytes(n);
  for (size_t i = 0; i < n; ++i)
    bytes[i] = static_cast<std::byte>(i < n / 2 ? i / 90 + i % 3 * 20 : i * i * 2654435761u >> 13);
  return bytes;
}

std::vector<std::string> settings_seeds() {
  RenderSettings spectral;
  spectral.item_buffer = ItemBuffer::checked;
  spectral.self_hit = SelfHit::medium;
  spectral.colour = ColourModel::spectral;
  spectral.colour_nodes_nm = {400, 500, 600, 700};
  return {text_of(encode_settings(RenderSettings())), text_of(encode_settings(spectral))};
}

SceneBlock block_of(const std::string& bytes) {
  SceneBlock block;
  block.size = bytes.size();
  block.data.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 64) / 64 * 64)));
  std::memcpy(block.data.get(), bytes.data(), bytes.size());
  return block;
}

std::vector<std::string> part_seeds(const Folder& folder) {
  std::vector<std::string> seeds;
  for (const char* scene :
       {"scenes/primitives.yaml", "scenes/animation.yaml", "tests/golden/scenes/stage.yaml"}) {
    const CompiledScene compiled =
        compile(load_scene(std::string(RAYFARM_SOURCE "/") + scene), {}, Purpose::library);
    seeds.push_back("b" + text_of(compiled.block.bytes()));
    write_part_file(folder.path + "/a.rfp", compiled.block, scene);
    seeds.push_back("f" + read_file(folder.path + "/a.rfp", limits::kFileBytes));
  }
  return seeds;
}

JobPlan make_plan() {
  JobPlan plan;
  plan.policy = AssignmentPolicy::interleaved;
  plan.processors = 3;
  plan.sets = SetPattern::rows;
  plan.build = "build";
  plan.pictures = {{FrameNumber(1), FrameNumber(2), FrameNumber(3)}, make_grid(0, 0, 64, 48, 2), {}};
  plan.time_factors = {1, 2};
  plan.settings = zeros(20);
  return plan;
}

JobPlan make_tapering_plan() {
  JobPlan plan = make_plan();
  plan.policy = AssignmentPolicy::on_demand;
  plan.pictures.grid = make_tapering_grid(0, 0, 256, 256, 20, kLeastBlockSide_px, kMostSubpolygonBytes);
  return plan;
}

}  // namespace

std::vector<Target> make_targets(const std::string& path) {
  const Folder folder{path};
  // Textures that scenes name are not there, but one.
  write_image(path + "/t.png", {2, 2, {0, 0, 2, 2}, make_pixel_layout(PixelFormat::rgb8), zeros(12)}, {});
  folder.write("a.mtl", kMtl);
  folder.write("a.obj", kObj);
  return {
      {"yaml",
       [folder](const std::string& bytes) {
         const std::string file = folder.write("in.yaml", bytes);
         read_yaml_both_ways(bytes, file);
         render_file(file);
       },
       scene_seeds(".yaml"),
       {"[",
        "]",
        "{",
        "}",
        ": ",
        ", ",
        "\n",
        "- ",
        "&a ",
        "*a",
        "1e308",
        "-1",
        ".nan",
        "0",
        "~",
        "\"",
        "  ",
        "use: ",
        "transform: ",
        "points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]",
        "triangles: [[0, 1, 2]]",
        "mesh: {file: a.obj}",
        "mix: {a: a, b: b, by: t}",
        "{spectrum: [[400, 0.5]]}",
        "kind: array",
        "image: t.png",
        "1e-300",
        "99999999999"}},
      {"nff",
       [folder](const std::string& bytes) {
         cut_nff(bytes);
         render_file(folder.write("in.nff", bytes));
       },
       {kNff},
       {"p 3\n", "s ", "c\n", "f ", "l ", " nan ", " inf ", " 1e308 ", " -1 ", "\n", "p 99999999\n", "pp 3\n",
        "#"}},
      {"obj",
       [folder](const std::string& bytes) {
         folder.write("a.mtl", kMtl);
         cut_obj(bytes, folder.write("a.obj", bytes));
         render_file(folder.write("obj.yaml", kYamlMesh));
       },
       {kObj, kSmoothObj},
       {"f ",
        "v ",
        "vn ",
        "vt ",
        "/",
        "//",
        "-1",
        "99999999999",
        "\n",
        "\\\n",
        "usemtl b\n",
        "nan",
        "1e39",
        "+1",
        "mtllib a.mtl\n",
        "f 1 2 3 4 3 2 1\n",
        "l 1 2\n",
        "s off\n",
        "s 2\n",
        " 1 .5 0\n",
        "3.1+e2",
        "# \\\n",
        "fo "}},
      {"ply",
       [folder](const std::string& bytes) {
         cut_ply(bytes);
         render_file(folder.write("in.ply", bytes));
       },
       ply_seeds(),
       {"element vertex 3\n", "element face 1\n", "element other 9\n", "property float nx\n",
        "property uchar red\n", "property list uchar int vertex_indices\n",
        "property list int8 double texcoord\n", "tristrips", "ascii", "binary_little_endian",
        "binary_big_endian", "end_header\n", "\r\n", "-1", "4294967295", "99999999999999999999", "nan",
        "1e39", "\xff\xff\xff\xff"}},
      {"stl",
       [folder](const std::string& bytes) {
         cut_stl(bytes);
         render_file(folder.write("in.stl", bytes));
       },
       stl_seeds(),
       {"solid x\n", "facet normal 0 0 1\n", "outer loop\n", "vertex 1 2 3\n", "endloop\n", "endfacet\n",
        "endsolid\n", "nan", "1e39", "\xff\xff\xff\xff", "\r"}},
      {"off",
       [folder](const std::string& bytes) { render_file(folder.write("in.off", bytes)); },
       {kOff, kColouredOff},
       {"STCNOFF\n", "COFF\n", "NOFF", "OFF BINARY", "4OFF", "3 ", "-1", "99999999999", "nan", "1e39", "#",
        "\n", "3 0 1 2\n"}},
      {"mtl",
       [folder](const std::string& bytes) {
         folder.write("a.obj", kObj);
         folder.write("a.mtl", bytes);
         render_file(folder.write("mtl.yaml", kYamlMesh));
       },
       {kMtl, kPhysicalMtl, kGlassMtl},
       {"newmtl a\n", "map_Kd ",   "-o ",        "-s 1 ",      "-bm ",        "t.png\n", "nan",
        "Kd ",        "Ns 1e39\n", "illum 99\n", "\n",         "Ke 9 9 9\n",  "d -1\n",  "Ni 0\n",
        "map_Bump ",  "norm ",     "map_d ",     "-clamp on ", "-imfchan r ", "Pr .5\n", "Pm 1\n",
        "Tf 0 1 2\n", "illum 7\n", "\\\n",       "-s 1e30 ",   "-o 1e300 ",   "1e38"}},
      {"gltf",
       [folder](const std::string& bytes) {
         render_file(folder.write(bytes.starts_with("glTF") ? "in.glb" : "in.gltf", bytes));
       },
       gltf_seeds(), gltf_words()},
      {"ies",
       [folder](const std::string& bytes) {
         GoniometricDiagram diagram;
         load_ies(folder.write("in.ies", bytes), diagram);
       },
       {kIes},
       {" ", "\n", "TILT=NONE\n", "TILT=INCLUDE\n", "99999999 ", "-1 ", "nan ", "1e308 ", "[X] y\n"}},
      {"npy",
       [folder](const std::string& bytes) {
         folder.write("in.npy", bytes);
         render_file(folder.write("npy.yaml", kYamlArray));
       },
       npy_seeds(),
       {"(", ")", ", ", "'<f8'", "'|u1'", "'<u2'", "'<f2'", "True", "False", "'shape': (1, 1, 1)",
        "99999999999", "1", "3"}},
      {"density",
       [folder](const std::string& bytes) {
         const bool is_nrrd = bytes.starts_with("NRRD");
         folder.write(is_nrrd ? "in.nrrd" : "in.raw", bytes);
         render_file(folder.write("density.yaml", yaml_medium(is_nrrd ? "file: in.nrrd" : kRawGrid)));
       },
       {std::string(24, '\x20'), kNrrd + std::string("\n\x01\x02\x03\x04\x05\x06\x07\x08"),
        kNrrd + std::string("data file: in.raw\nspacings: 1 1 1\n\n")},
       {"\n", "\n\n", "sizes: 1 1 1\n", "type: float\n", "type: ushort\n", "endian: big\n",
        "endian: little\n", "data file: in.nrrd\n", "byte skip: -1\n", "encoding: gzip\n", "99999999999 ",
        "0 ", "# x\n", "a:=b\n"}},
      {"image", [folder](const std::string& bytes) { read_images(folder, bytes); }, image_seeds(folder), {}},
      {"message", decode_messages, message_seeds(), {}},
      {"block",
       [](const std::string& bytes) { decompress_rgb8(bytes_of(bytes), 64, 48); },
       {text_of(compress_rgb8(zeros(3 * 64 * 48), 64, 48)),
        text_of(compress_rgb8(uneven(3 * 64 * 48), 64, 48))},
       {}},
      {"plan",
       [](const std::string& bytes) {
         const JobPlan plan = decode_plan(bytes_of(bytes));
         const PicturesPhase& pictures = plan.pictures;
         const SubpolygonGrid& grid = pictures.grid;
         for (const SubpolygonId s : {SubpolygonId(0), SubpolygonId(grid.count() - 1)}) {
           grid.find(grid.polygon(s));
           owner_of(plan, pictures, pictures.item_of(FrameIndex(2), s));
         }
       },
       {text_of(encode_plan(make_plan())), text_of(encode_plan(make_tapering_plan()))},
       {}},
      {"settings", [](const std::string& bytes) { decode_settings(bytes_of(bytes)); }, settings_seeds(), {}},
      {"part",
       [folder](const std::string& bytes) {
         if (bytes.empty()) return;
         // A whole file, or a block in a file that is whole but for it.
         if (bytes[0] == 'f')
           folder.write("a.rfp", bytes.substr(1));
         else
           write_part_file(folder.path + "/a.rfp", block_of(bytes.substr(1)), "a.yaml");
         render_file(folder.write("part.yaml", kYamlPart));
       },
       part_seeds(folder),
       {},
       true},
      {"scene",
       [](const std::string& bytes) {
         const SceneBlock block = block_of(bytes);
         render(decode_scene(block.bytes()), 0);
       },
       block_seeds(),
       {},
       true},
      {"journal",
       [folder](const std::string& bytes) { read_journal_bytes(folder, bytes); },
       {journal_seed(folder)},
       {"rayfarm-journal 1\n", "\ncolumns ", "\nrows "}},
      {"zones", [path](const std::string& bytes) { read_zones(path, bytes); }, zone_seeds(path), {}},
  };
}

}  // namespace rayfarm::fuzz
