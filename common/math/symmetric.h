#pragma once
#include "common/math/vector.h"

namespace rayfarm {

/// Eigenvectors of a symmetric matrix as columns, by Jacobi's rotations; `m` becomes diagonal.
/// What is off it and less than `noise` times what is on it is rounding.
Mat3 diagonalize(Mat3& m, double noise = 0);

}  // namespace rayfarm
