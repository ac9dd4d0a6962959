#include "host/commands/commands.h"

#include "protocol/build_identity.h"

namespace rayfarm {
namespace {

class Commands : public CommandLine {
 public:
  explicit Commands(const std::string& version)
      : CommandLine("rayfarm", "Rayfarm: a ray tracing render farm on Open MPI", version) {
    for (const auto add : {add_render_command, add_bake_command, add_check_command, add_info_command,
                           add_compile_command, add_convert_command, add_compare_command,
                           add_experiment_command, add_model_command, add_simulate_command})
      add(*this);
  }
};

}  // namespace

Request read_command_line(int argc, char** argv) {
  return Commands(RAYFARM_VERSION ", build " + build_identity()).parse(argc, argv);
}

ProgramOutline outline_of_commands() {
  return Commands(RAYFARM_VERSION).outline();
}

}  // namespace rayfarm
