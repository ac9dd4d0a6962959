#pragma once
// OBJ, MTL, PLY, STL and OFF files that the fuzzer changes, in text and in bytes.
#include <cstdint>
#include <string>
#include <vector>

namespace rayfarm::fuzz {

inline constexpr const char* kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 1\nusemtl a\ns 1\n"
    "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -1 -2 -3\nf 1 2 3 4 2\ng x\no y\nf 1//1 2//1 3//1\n";
inline constexpr const char* kMtl =
    "newmtl a\nKd 1 .5 0\nKs .2 .2 .2\nNs 20\nillum 3\nd 0.5\nNi 1.5\nmap_Kd -o 0.1 0 -s 2 2 t.png\nKe 0 0 "
    "0\n";
inline constexpr const char* kSmoothObj =
    "mtllib a.mtl\nv 0 0 0 1 .5 0\nv 1 0 \\\n0\nv 1 1 0 255 0 1\nv 0 1 3.1+e0\ns 1\nf 1// 2/ 3\ns 2\nf 1 3 4 "
    "# end\n"
    "s off\nusemtl a\nfo +1 3 2\n";
inline constexpr const char* kPhysicalMtl =
    "newmtl a\nKd 1 .5 0\nPr .3\nPm 1\nPc .5\nPcr .1\nKs .5 .5 .5\nmap_Pr -imfchan g -clamp on t.png\nmap_Pm "
    "t.png\n"
    "norm -bm .5 t.png\nmap_Ke t.png\n";
inline constexpr const char* kGlassMtl =
    "newmtl a\nKd 0 0 0\nKs 1 1 1\nillum 7\nTr .9\nTf 1 .5 1\nmap_Bump t.png -bm 2\nmap_Ks t.png\nnewmtl "
    "b\nKd 1 1 1\n"
    "Ns 90\nd .5\nmap_d t.png\n";
inline constexpr const char* kYamlMesh =
    "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{mesh: {file: a.obj, smooth: phong}}]\n";

inline constexpr const char* kOff =
    "OFF\n4 2 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0 # x\n3 0 1 2\n4 0 1 2 3 255 0 0\n";
inline constexpr const char* kColouredOff =
    "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 9 1 0 0\n1 0 0 0 0 1 255 0 9 1 1 0\n0 1 0 0 0 1 255 0 9 1 0 1\n3 0 1 "
    "2\n";

inline std::vector<std::string> ply_seeds() {
  const std::string elements =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty float s\nproperty float t\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n";
  std::vector<std::string> seeds{
      "ply\nformat ascii 1.0\n" + elements +
      "0 0 0 1 2 3 0 0\n1 0 0 1 2 3 1 0\n1 1 0 1 2 3 1 1\n0 1 0 1 2 3 0 1\n3 0 1 2 0\n"
      "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n6 0 1 2 -1 3 2\n"};
  for (const bool is_big : {false, true}) {
    std::string body;
    const auto add = [&](uint32_t word) {
      for (int i = 0; i < 4; ++i) body += static_cast<char>(word >> 8 * (is_big ? 3 - i : i) & 0xff);
    };
    for (uint32_t i = 0; i < 4; ++i) {
      for (const bool is_one : {i == 1 || i == 2, i >= 2, false}) add(is_one ? 0x3f800000u : 0u);
      body += "abc";
      add(0);
      add(0x3f800000u);
    }
    body += '\3';
    for (const uint32_t corner : {0u, 1u, 2u}) add(corner);
    body += '\0';
    body += '\4';
    for (const uint32_t corner : {0u, 1u, 2u, 3u}) add(corner);
    body += '\0';
    add(4);
    for (const uint32_t corner : {0u, 1u, 2u, 3u}) add(corner);
    seeds.push_back(std::string("ply\nformat binary_") + (is_big ? "big" : "little") + "_endian 1.0\n" +
                    elements + body);
  }
  return seeds;
}

inline std::vector<std::string> stl_seeds() {
  std::string bytes(80, ' ');
  bytes += std::string("\2\0\0\0", 4);
  for (int facet = 0; facet < 2; ++facet)
    for (int i = 0; i < 12; ++i) bytes += std::string(i % 4 == facet ? "\0\0\x80\x3f" : "\0\0\0\0", 4);
  bytes.insert(bytes.size() - 48, 2, '\0');
  bytes += std::string(2, '\0');
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n endloop\nendfacet\n";
  return {"solid a\n" + facet + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n", bytes};
}

}  // namespace rayfarm::fuzz
