// render_scene SCENE PICTURE WIDTH HEIGHT: the scene's first frame, with the settings of `rayfarm render`
// that stand where no option is given.
#include <rayfarm.h>

#include <exception>
#include <iostream>

int main(int argc, char** argv) try {
  if (argc != 5) {
    std::cerr << "usage: render_scene SCENE PICTURE WIDTH HEIGHT\n";
    return 2;
  }
  using namespace rayfarm;
  const std::string picture = argv[2];
  const SceneDescription description = load_scene(argv[1]);
  const CompiledScene compiled = compile(description);
  for (const std::string& note : compiled.notes.lines()) std::cerr << note << "\n";

  RenderSettings settings;
  settings.width_px = std::stoi(argv[3]);
  settings.height_px = std::stoi(argv[4]);
  settings.crop = {0, 0, settings.width_px, settings.height_px};
  settings.pixel_format = natural_format(picture);
  check_settings(settings);

  const int frame = description.frames ? (*description.frames)[0] : 0;
  RenderedPixels rendered = Renderer(compiled.scene, settings).render(frame, settings.crop, [] {});
  write_image(picture,
              {settings.width_px, settings.height_px, settings.crop, make_pixel_layout(settings.pixel_format),
               std::move(rendered.pixels)},
              {{"rayfarm/seed", std::to_string(settings.seed)}});
  return 0;
} catch (const std::exception& problem) {
  std::cerr << problem.what() << "\n";
  return 1;
}
