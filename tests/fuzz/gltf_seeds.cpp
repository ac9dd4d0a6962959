#include "tests/fuzz/gltf_seeds.h"

#include <cstdint>
#include <cstring>

namespace rayfarm::fuzz {
namespace {

/// Of a square with all that vertices may have.
std::string buffer() {
  std::string bytes;
  const auto floats = [&](std::initializer_list<float> values) {
    for (const float value : values) bytes.append(reinterpret_cast<const char*>(&value), 4);
  };
  const auto halves = [&](std::initializer_list<uint16_t> values) {
    for (const uint16_t value : values) bytes.append(reinterpret_cast<const char*>(&value), 2);
  };
  floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});                                          // 0: positions
  floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});                                          // 48: normals
  floats({0, 0, 1, 0, 1, 1, 0, 1});                                                      // 96: uvs
  bytes += std::string("\xff\x80\x20\x80\x10\xff\x30\xff", 8) + std::string(8, '\x7f');  // 128: colours
  bytes += std::string("\0\1\0\0\1\0\0\0\0\0\0\0\1\1\0\0", 16);                          // 144: joints
  floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 0.2f, 0.8f, 0, 0});                  // 160: weights
  halves({0, 1, 2, 0, 2, 3});                                                            // 224: indices
  floats({0, 1});                                                                        // 236: times
  floats({0, 0, 0, 1, 0, 0.6f, 0, 0.8f});                                                // 244: rotations
  halves({1, 2});                                             // 276: sparse indices
  floats({1, 0, 1, 1, 1, 1});                                 // 280: sparse values
  floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});  // 304: a matrix
  floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});  // 368: another
  floats({0, 1, 0.5f, 0});                                    // 432: weights in time
  return bytes;
}

constexpr const char* kLists = R"(
"bufferViews":[{"buffer":0,"byteLength":448},{"buffer":0,"byteOffset":0,"byteLength":48,"byteStride":12}],
"accessors":[
{"bufferView":1,"componentType":5126,"type":"VEC3","count":4},
{"bufferView":0,"byteOffset":48,"componentType":5126,"type":"VEC3","count":4},
{"bufferView":0,"byteOffset":96,"componentType":5126,"type":"VEC2","count":4},
{"bufferView":0,"byteOffset":128,"componentType":5121,"normalized":true,"type":"VEC4","count":4},
{"bufferView":0,"byteOffset":144,"componentType":5121,"type":"VEC4","count":4},
{"bufferView":0,"byteOffset":160,"componentType":5126,"type":"VEC4","count":4},
{"bufferView":0,"byteOffset":224,"componentType":5123,"type":"SCALAR","count":6},
{"bufferView":0,"byteOffset":236,"componentType":5126,"type":"SCALAR","count":2},
{"bufferView":0,"byteOffset":244,"componentType":5126,"type":"VEC4","count":2},
{"componentType":5126,"type":"VEC3","count":4,"sparse":{"count":2,"indices":{"bufferView":0,"byteOffset":276,
"componentType":5123},"values":{"bufferView":0,"byteOffset":280}}},
{"bufferView":0,"byteOffset":304,"componentType":5126,"type":"MAT4","count":2},
{"bufferView":0,"byteOffset":432,"componentType":5126,"type":"SCALAR","count":2}],
"images":[{"uri":"t.png"}],"samplers":[{"wrapS":33071,"wrapT":33648,"magFilter":9728}],"textures":[{"source":0,"sampler":0}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.2,0.5],"baseColorTexture":{"index":0,"extensions":
{"KHR_texture_transform":{"offset":[0.1,0],"rotation":1,"scale":[2,2]}}},"metallicRoughnessTexture":{"index":0,"texCoord":1}},
"alphaMode":"BLEND","normalTexture":{"index":0,"scale":0.5},"emissiveFactor":[1,0,0],"extensions":{
"KHR_materials_emissive_strength":{"emissiveStrength":2},"KHR_materials_ior":{"ior":1.4},"KHR_materials_clearcoat":
{"clearcoatFactor":1},"KHR_materials_specular":{"specularFactor":0.5}}},
{"doubleSided":true,"alphaMode":"MASK","extensions":{"KHR_materials_transmission":{"transmissionFactor":1},
"KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[1,0.5,0.5],"attenuationDistance":2}}},
{"extensions":{"KHR_materials_unlit":{}}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"TEXCOORD_1":2,"COLOR_0":3},"indices":6,"material":0}]},
{"weights":[0.5],"primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"mode":5,"targets":[{"POSITION":9}],"material":1}]},
{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":4,"WEIGHTS_0":5},"mode":6,"material":2},{"attributes":{"POSITION":9},"mode":0}]}],
"skins":[{"joints":[3,4],"inverseBindMatrices":10}],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}},{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":9}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5},
{"type":"spot","spot":{"outerConeAngle":0.7}},{"type":"directional"}]}},
"nodes":[{"mesh":0,"translation":[0,0,-1]},{"mesh":1,"scale":[1,2,1]},{"mesh":2,"skin":0},{"children":[4]},{"translation":[0,1,0]},
{"camera":0,"translation":[0,0,4]},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,2,0,0,1],"extensions":{"KHR_lights_punctual":{"light":0}}}],
"scenes":[{"nodes":[0,1,2,3,5,6]}],
"animations":[{"name":"a","samplers":[{"input":7,"output":8},{"input":7,"output":11}],"channels":[
{"sampler":0,"target":{"node":4,"path":"rotation"}},{"sampler":1,"target":{"node":1,"path":"weights"}}]}]})";

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : bytes) {
    bits = bits << 8 | static_cast<uint8_t>(c);
    for (count += 8; count >= 6; count -= 6) text += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kDigits[bits << (6 - count) & 63];
  while (text.size() % 4 != 0) text += '=';
  return text;
}

std::string word(size_t n) {
  const auto w = static_cast<uint32_t>(n);
  return {reinterpret_cast<const char*>(&w), 4};
}

}  // namespace

std::vector<std::string> gltf_seeds() {
  const std::string head = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":448)", bytes = buffer();
  const std::string text = head + R"(,"uri":"data:;base64,)" + base64(bytes) + "\"}]," + kLists;
  std::string json = head + "}]," + kLists;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return {text, "glTF" + word(2) + word(28 + json.size() + bytes.size()) + word(json.size()) + "JSON" + json +
                    word(bytes.size()) + std::string("BIN\0", 4) + bytes};
}

std::vector<std::string> gltf_words() {
  return {"[",
          "]",
          "{",
          "}",
          ",",
          "\"",
          ":",
          "0",
          "1",
          "2",
          "3",
          "-1",
          "1e308",
          "1e-300",
          "99999999999",
          "0.5",
          "null",
          "true",
          "\"sparse\":{",
          "\"mode\":5",
          "\"children\":[1]",
          "\"mesh\":0",
          "\"skin\":0",
          "\"matrix\":[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]",
          "\"scale\":[0,0,0]",
          "\"byteStride\":0",
          "5121",
          "5123",
          "5125",
          "5126",
          "\"normalized\":true",
          "\"STEP\"",
          "\"CUBICSPLINE\"",
          "\"MASK\""};
}

}  // namespace rayfarm::fuzz
