#include "host/commands/commands.h"

#include "protocol/build_identity.h"

namespace rayfarm {

Request read_command_line(int argc, char** argv) {
  CommandLine line("rayfarm", "Rayfarm: a ray tracing render farm on Open MPI",
                   RAYFARM_VERSION ", build " + build_identity());
  for (const auto add : {add_render_command, add_bake_command, add_check_command, add_info_command,
                         add_compile_command, add_convert_command, add_compare_command,
                         add_experiment_command, add_model_command, add_simulate_command})
    add(line);
  return line.parse(argc, argv);
}

}  // namespace rayfarm
