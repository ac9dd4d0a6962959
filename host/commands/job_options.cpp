#include "host/commands/job_options.h"

#include <fmt/core.h>

namespace rayfarm {

void add_depth_options(Options& options, RenderOptions& o) {
  options.number(
      "--max-depth", o.max_depth, 1, kMostDepth,
      "depth of the lighting tree; the eye ray is 1 (default: what the two limits below need, 12; path: "
      "100)");
  options.number(
      "--max-reflections", o.max_reflections, 0, kMostDepth - 1,
      "reflected and diffuse rays on a branch of the tree (default: 4; with --max-depth or path: as "
      "deep as the tree)");
  options.number(
      "--max-transmissions", o.max_transmissions, 0, kMostDepth - 1,
      "transmitted rays on a branch of the tree (default: 7; with --max-depth or path: as deep as the "
      "tree)");
}

void add_self_hit_option(Options& options, RenderOptions& o) {
  options.choice<SelfHit>("--self-hit", o.settings.self_hit, choices<SelfHit>(kSelfHitWords),
                          "what keeps rays from the surface that they leave: they start off it by a bound on "
                          "rounding, or exactly on it, and can't hit a side on which there is not the medium "
                          "that they are in, as closed bodies let them (default: bound)");
}

void add_assign_option(Options& options, RenderOptions& o) {
  options.choice<AssignmentPolicy>(
      "--assign", o.policy,
      {{"interleaved", AssignmentPolicy::interleaved}, {"on-demand", AssignmentPolicy::on_demand}},
      "who traces what (default: on-demand)");
}

void add_node_options(Options& options, RenderOptions& o) {
  options.number("--local-nodes", o.local_nodes, 1, 256,
                 "without mpirun: how many nodes run inside this process (default: one per core)");
  options
      .number("--node-timeout", o.node_timeout_s, liveness::kLeastNodeTimeout_s, liveness::kMostNodeTimeout_s,
              "seconds of silence after which a node is lost (default: 8)")
      .takes("S");
}

void add_progress_option(Options& options, RenderOptions& o) {
  options.choice<ProgressStyle>(
      "--progress", o.progress,
      {{"auto", ProgressStyle::automatic},
       {"json", ProgressStyle::json},
       {"none", ProgressStyle::none},
       {"plain", ProgressStyle::plain},
       {"tty", ProgressStyle::tty}},
      "how progress is shown; json: a line each second, for programs (default: auto)");
}

void add_quiet_options(Options& options, RenderOptions& o) {
  options.flag("-q,--quiet", o.is_quiet, "errors only");
  options.flag("-v,--verbose", o.is_verbose, "tell more");
}

void set_limits(RenderOptions& o) {
  RenderSettings& s = o.settings;
  const bool is_path = follows_paths(s.lighting), has_depth = o.max_depth || is_path;
  if (has_depth) limit_by_depth(s, o.max_depth.value_or(kPathDepth));
  s.max_reflections = o.max_reflections.value_or(s.max_reflections);
  s.max_transmissions = o.max_transmissions.value_or(s.max_transmissions);
  if (!has_depth) s.max_depth = 1 + s.max_reflections + s.max_transmissions;
  if (s.max_depth > kMostDepth)
    throw UsageError(
        fmt::format("--max-reflections {} and --max-transmissions {} make a tree of depth {}, more than {}; "
                    "lower one of them",
                    s.max_reflections, s.max_transmissions, s.max_depth, kMostDepth));
  const auto check = [&s](const char* name, uint32_t limit) {
    if (limit >= s.max_depth)
      throw UsageError(fmt::format(
          "{} {} can't be reached: a tree of depth {} has {} rays on a branch after the eye ray; raise "
          "--max-depth or leave the limit out",
          name, limit, s.max_depth, s.max_depth - 1));
  };
  check("--max-reflections", s.max_reflections);
  check("--max-transmissions", s.max_transmissions);
}

}  // namespace rayfarm
