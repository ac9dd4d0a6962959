#include "host/commands/commands.h"

namespace rayfarm {
namespace {

class Commands : public CommandLine {
 public:
  Commands() : CommandLine("rayfarm", "Rayfarm: a ray tracing render farm on Open MPI", RAYFARM_VERSION) {
    for (const auto add : {add_render_command, add_bake_command, add_check_command, add_info_command,
                           add_compile_command, add_convert_command, add_compare_command,
                           add_experiment_command, add_model_command, add_simulate_command})
      add(*this);
  }
};

}  // namespace

Request read_command_line(int argc, char** argv) {
  return Commands().parse(argc, argv);
}

ProgramOutline outline_of_commands() {
  return Commands().outline();
}

}  // namespace rayfarm
