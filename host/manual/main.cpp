// rayfarm_manual FOLDER: writes manual pages and completions there, from the same options that --help tells.
// It runs while Rayfarm is built, and isn't installed.
#include <exception>
#include <filesystem>

#include "host/commands/commands.h"
#include "host/files/text_file.h"
#include "host/manual/completions.h"
#include "host/manual/man_page.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"

using namespace rayfarm;

int main(int argc, char** argv) try {
  if (argc != 2) {
    say("usage: rayfarm_manual FOLDER\n");
    return kUsageError;
  }
  const std::string folder = argv[1] + std::string("/");
  const ProgramOutline program = outline_of_commands();
  for (const char* kind : {"man1", "bash", "zsh", "fish"}) std::filesystem::create_directories(folder + kind);
  write_text_file(folder + "man1/rayfarm.1", man_page_of(program));
  for (const CommandOutline& command : program.commands)
    write_text_file(folder + "man1/rayfarm-" + command.name + ".1", man_page_of(program, command));
  write_text_file(folder + "bash/rayfarm", bash_completion_of(program));
  write_text_file(folder + "zsh/_rayfarm", zsh_completion_of(program));
  write_text_file(folder + "fish/rayfarm.fish", fish_completion_of(program));
  return kComplete;
} catch (const std::exception& e) {
  say("rayfarm_manual: {}\n", e.what());
  return kRenderFailure;
}
