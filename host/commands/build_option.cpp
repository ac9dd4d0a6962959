#include "host/commands/build_option.h"

namespace rayfarm {

void add_build_option(Options& options, BuildQuality& quality) {
  options.choice<BuildQuality>(
      "--build", quality,
      {{"balanced", BuildQuality::balanced}, {"fast", BuildQuality::fast}, {"high", BuildQuality::high}},
      "of --hierarchy sah: leave primitives whole; or divide large ones among volumes where that pays, up to "
      "1.3 or to 2 references each; pictures are the same (default: balanced)");
}

}  // namespace rayfarm
