#include "host/commands/load_options.h"

namespace rayfarm {

void add_load_options(Options& options, LoadOptions& load) {
  options.begin_group("Scene");
  options
      .text("--clip", load.clip, "which clip of a glTF file moves it, by name or number from 0 (default: 0)",
            "NAME|N")
      .for_users();
  options
      .text("--camera", load.camera,
            "through which camera of a glTF file it is seen, by name or number from 0 (default: 0)", "NAME|N")
      .for_users();
  options.number("--fps", load.fps, 0.01, 10'000, "frames in a second of a glTF file's clip (default: 24)")
      .for_users();
  options
      .choice<UpAxis>("--up", load.up, {{"y", UpAxis::y}, {"z", UpAxis::z}},
                      "which axis of a mesh's file is up, where the mesh is the scene (default: z of .stl, "
                      "else y)")
      .for_users();
}

}  // namespace rayfarm
