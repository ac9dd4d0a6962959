#pragma once
// A colour as Shirley, Sung and Brown had it first (1991, section 2.1): "a piecewise linear approximation
// with arbitrary node locations". "When two colors were combined by an operation, a new color with possibly
// more nodes was generated", so a colour is a list without bound.
#include "common/materials/spectrum.h"

namespace rayfarm {

/// By rising wavelength.
using LinearColour = std::vector<SpectrumNode>;

/// At the nodes of both, in a list of its own.
LinearColour operator*(const LinearColour& a, const LinearColour& b);
LinearColour operator+(const LinearColour& a, const LinearColour& b);

}  // namespace rayfarm
