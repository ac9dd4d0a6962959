#pragma once
// The renderer as other programs use it (find_package(rayfarm), rayfarm::renderer):
//   load_scene      a file -> SceneDescription
//   compile         SceneDescription -> CompiledScene, which holds hierarchies and all that rays need
//   Renderer        CompiledScene and RenderSettings -> pixels of any rectangle of any frame; one for each
//   thread write_image     pixels -> .exr or .png
// Problems are thrown: InputError (a scene is wrong), IoError (a file), SettingsError. The pixels are those
// that `rayfarm render` gives, to the byte. Solving zones, which the lighting models radiosity and zonal
// read, is left to `rayfarm render`.
#include "common/compile/compile.h"
#include "common/errors/input_error.h"
#include "common/image/image_file.h"
#include "common/lighting/renderer.h"
#include "common/scene/settings_codec.h"
