// rayfarm on the SIMD target that RAYFARM_SIMD names, so that pictures of all targets can be compared on one
// machine; `list` prints those that it has, a line each.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "common/hierarchy/traverser.h"

namespace {

/// Before main: nothing has been traced by then.
const bool is_forced = [] {
  const char* const name = std::getenv("RAYFARM_SIMD");
  if (!name) return false;
  if (name == std::string("list")) {
    for (const std::string& target : rayfarm::simd_targets()) std::puts(target.c_str());
    std::exit(0);
  }
  rayfarm::force_simd_target(name);
  return true;
}();

}  // namespace
