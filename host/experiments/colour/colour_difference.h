#pragma once
// How different two colours look.
#include "common/math/vector.h"

namespace rayfarm {

/// CIE L*a*b* of a linear Rec. 709 colour, whose white, D65, has L* = 100.
Vec3 lab_of(const Color& rgb);

/// The CIEDE2000 difference of two L*a*b* colours with its weights at 1 (CIE 142-2001; Sharma, Wu and Dalal
/// 2005, "The CIEDE2000 color-difference formula", equations 2 to 22). About 1 is just seen side by side.
double ciede2000(const Vec3& a, const Vec3& b);

}  // namespace rayfarm
