#pragma once
#include <string>
#include <vector>

namespace rayfarm::fuzz {

/// A glTF file with something of all that is read of them, as text and binary; it names t.png.
std::vector<std::string> gltf_seeds();
std::vector<std::string> gltf_words();

}  // namespace rayfarm::fuzz
