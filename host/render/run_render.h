#pragma once
#include <functional>

namespace rayfarm {

struct RenderOptions;

/// Runs one render and returns its exit code.
using RunRender = std::function<int(const RenderOptions&)>;

}  // namespace rayfarm
