#pragma once
// Photometric files of the IES (LM-63-1995, LM-63-2002), photometry of type C.
#include <string>
#include <vector>

#include "common/errors/stop.h"
#include "common/scene/goniometry.h"

namespace rayfarm {

/// The values of a diagram in candela, laid out as GoniometricDiagram tells; sets its counts. Throws
/// InputError with the line, IoError, Stopped.
std::vector<double> load_ies(const std::string& path, GoniometricDiagram& diagram,
                             const std::stop_token& stop = {});

}  // namespace rayfarm
