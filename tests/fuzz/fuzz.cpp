// The loop: seeds are changed and read until the time is over. tests/fuzz/README.md tells how to use it.
#include <fmt/core.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/description/formats/scene_loaders.h"
#include "common/files/read_file.h"
#include "common/scene/scene_block.h"
#include "common/scene/settings_codec.h"
#include "protocol/clock.h"
#include "protocol/protocol_error.h"
#include "tests/fuzz/mutation.h"
#include "tests/fuzz/targets.h"

extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

namespace rayfarm::fuzz {
namespace {

constexpr time_t kMostSecondsForOneInput = 10;

/// What is being read, for the report if the process dies of it.
const Target* current_target = nullptr;
const std::string* current_input = nullptr;
uint64_t current_seed = 0;

std::string keep_finding() {
  const std::string file = fmt::format("fuzz-finding-{}-{}", current_target->name, current_seed);
  std::ofstream(file, std::ios::binary) << *current_input;
  return file;
}

void on_death() {
  if (current_input)
    fmt::print(stderr, "fuzz: {}: died; the input is in {}\n", current_target->name, keep_finding());
}

void on_alarm(int) {
  fmt::print(stderr, "fuzz: {}: one input takes more than {} s; it is in {}\n", current_target->name,
             kMostSecondsForOneInput, keep_finding());
  std::abort();
}

/// In processor time, so that a busy machine finds nothing.
void set_alarm(time_t seconds) {
  const itimerval timer{{}, {seconds, 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

/// False if the input is a finding.
bool run(const Target& target, const std::string& input) {
  current_target = &target;
  current_input = &input;
  set_alarm(kMostSecondsForOneInput);
  std::string problem;
  try {
    target.run(input);
  } catch (const InputError&) {
  } catch (const IoError&) {
  } catch (const ProtocolError&) {
  } catch (const SceneBlockError&) {
  } catch (const SettingsError&) {
  } catch (const std::domain_error&) {  // a view or pose that a frame can't have
  } catch (const std::exception& e) {
    problem = e.what();
  }
  set_alarm(0);
  if (!problem.empty())
    fmt::print(stderr, "fuzz: {}: '{}' is no error that an input should end in; it is in {}\n", target.name,
               problem, keep_finding());
  current_input = nullptr;
  return problem.empty();
}

/// Findings of the past: files named TARGET-WHAT.
std::vector<std::string> regressions_of(const Target& target) {
  std::vector<std::string> inputs;
  for (const auto& entry : std::filesystem::directory_iterator(RAYFARM_SOURCE "/tests/fuzz/regressions"))
    if (entry.path().filename().string().starts_with(target.name + "-"))
      inputs.push_back(read_file(entry.path(), limits::kFileBytes));
  return inputs;
}

struct Options {
  std::string target, input;
  double seconds = 60;
  uint64_t seed = 1;
};

int fuzz(const Options& options) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("rayfarm-fuzz-{}", getpid());
  std::filesystem::create_directories(folder);
  std::vector<Target> targets = make_targets(folder.string());
  if (!options.target.empty())
    std::erase_if(targets, [&](const Target& t) { return t.name != options.target; });
  if (targets.empty()) {
    fmt::print(stderr, "fuzz: there is no target '{}'\n", options.target);
    return 2;
  }
  current_seed = options.seed;  // runs side by side keep their findings apart
  signal(SIGPROF, on_alarm);
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(on_death);
  int findings = 0;
  if (!options.input.empty()) return run(targets[0], read_file(options.input, limits::kFileBytes)) ? 0 : 1;
  for (const Target& target : targets) {
    if (target.seeds.empty()) {
      fmt::print(stderr, "fuzz: target '{}' has no seeds\n", target.name);
      return 2;
    }
    for (const std::string& input : regressions_of(target)) findings += run(target, input) ? 0 : 1;
    for (const std::string& seed : target.seeds) findings += run(target, seed) ? 0 : 1;
    Mutator mutator(options.seed, target.words, target.keeps_size);
    uint64_t runs = 0;
    const int before = findings;
    for (const double end = now_s() + options.seconds / static_cast<double>(targets.size());
         now_s() < end && findings == before; ++runs) {
      const std::string& seed = target.seeds[mutator.below(target.seeds.size())];
      findings += run(target, mutator.mutate(seed, target.seeds[mutator.below(target.seeds.size())])) ? 0 : 1;
    }
    fmt::print("{:<10} {:>8} inputs\n", target.name, runs);
  }
  std::filesystem::remove_all(folder);
  fmt::print("{} findings\n", findings);
  return findings == 0 ? 0 : 1;
}

}  // namespace
}  // namespace rayfarm::fuzz

int main(int argc, char** argv) {
  rayfarm::fuzz::Options options;
  CLI::App app{"Reads damaged input with every parser and decoder", "fuzz"};
  app.add_option("--target", options.target, "only this one");
  app.add_option("--input", options.input, "only this file");
  app.add_option("--seconds", options.seconds, "in all");
  app.add_option("--seed", options.seed, "of the random numbers");
  CLI11_PARSE(app, argc, argv);
  return rayfarm::fuzz::fuzz(options);
}
