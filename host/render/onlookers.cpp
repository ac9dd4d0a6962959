#include "host/render/onlookers.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "host/process/console.h"
#include "host/process/exit_code.h"

namespace rayfarm {

Onlookers::Onlookers(const RenderOptions& options, std::function<void(const std::string&)> tell) {
  if (options.display) {
    try {
      tev_ = std::make_unique<TevDisplay>(*options.display, std::move(tell));
    } catch (const std::runtime_error& e) {
      throw JobError(kUsageError, fmt::format("--display: the host '{}' is not known here: {}",
                                              options.display->host, e.what()));
    }
  }
  if (!options.view_port) return;
  view_ = std::make_unique<FarmView>(options.scene, options.output);
  try {
    server_.emplace(*options.view_port, *view_);
  } catch (const std::runtime_error& e) {
    throw JobError(kUsageError,
                   fmt::format("--view {}: no page can be shown at 127.0.0.1:{} ({}); choose another "
                               "port, or give none and any that is free is taken",
                               *options.view_port, *options.view_port, e.what()));
  }
  say("rayfarm: look at {}\n", server_->url());
}

std::vector<Watcher*> Onlookers::watchers() const {
  std::vector<Watcher*> watchers;
  if (view_) watchers.push_back(view_.get());
  if (tev_) watchers.push_back(tev_.get());
  return watchers;
}

void Onlookers::end(int exit_code) {
  if (tev_) tev_->end();
  if (!view_) return;
  const auto word = std::find_if(kExitCodeWords.begin(), kExitCodeWords.end(),
                                 [exit_code](const auto& w) { return w.first == exit_code; });
  view_->end(word != kExitCodeWords.end() ? word->second : fmt::format("exit code {}", exit_code));
  server_->let_pages_see_the_end();
  server_.reset();
}

}  // namespace rayfarm
