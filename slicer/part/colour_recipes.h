// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the colours of a print are made with, shown to those who count its resins.
#pragma once

#include "halftone/loop/minimal_depth_separation.h"
#include "halftone/separation/separation.h"

namespace voxtone::slicer {

/// `recipes`: of the loop, null where there is none.
struct ColourRecipes {
    const optics::ShellAppearance& appearance;
    const halftone::Separation& separation;
    const halftone::MinimalDepthSeparation* recipes = nullptr;
};

}  // namespace voxtone::slicer
