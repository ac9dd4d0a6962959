#pragma once

namespace rayfarm {

/// From now on Ctrl-C, SIGTERM and SIGHUP ask the host to stop; a second one ends the process at once.
/// A closed pipe on stdout or stderr ends nothing.
void catch_interrupts();
/// The signal that asked the host to stop, or 0.
int interrupted_by();

}  // namespace rayfarm
