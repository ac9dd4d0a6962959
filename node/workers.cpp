#include "node/node.h"

namespace rayfarm {

Workers make_workers() {
  return {make_scene_worker, {}};
}

}  // namespace rayfarm
