#include "host/commands/build_option.h"

namespace rayfarm {

void add_build_option(Options& options, BuildQuality& quality) {
  options.choice<BuildQuality>(
      "--build", quality,
      {{"fast", BuildQuality::fast}, {"balanced", BuildQuality::balanced}, {"high", BuildQuality::high}},
      "fast leaves primitives whole; balanced divides large ones among volumes where that pays, up to 1.3 "
      "references a primitive on average, high up to 2; not with the thesis's hierarchy; pictures are the "
      "same (default: balanced)");
}

}  // namespace rayfarm
