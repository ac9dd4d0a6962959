#include "host/experiments/plots.h"

#include <fmt/core.h>

#include <cstdlib>

#include "host/files/text_file.h"

namespace rayfarm {

void draw_plots(const std::filesystem::path& folder, const std::string& file, const std::string& script) {
  write_text_file((folder / file).string(), script);
  const std::string command = fmt::format("cd '{}' && gnuplot {}", folder.string(), file);
  if (std::system("command -v gnuplot >/dev/null") != 0)
    fmt::print(stderr,
               "rayfarm: gnuplot was not found, so the plots are not drawn; apt-get install gnuplot-nox, "
               "then gnuplot {} in {}\n",
               file, folder.string());
  else if (std::system(command.c_str()) != 0)
    fmt::print(stderr, "rayfarm: gnuplot could not draw the plots\n");
}

}  // namespace rayfarm
