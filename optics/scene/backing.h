// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace voxtone::optics {

/// What lies under a body of finite thickness. There is air between the body's smooth lower surface and a sheet.
enum class Backing {
    none,   ///< nothing: the body floats, and the same white light reaches it from below
    black,  ///< a sheet that absorbs everything
    white,  ///< a sheet that reflects everything, diffusely
    sheet,  ///< one that reflects as the scene's `sheet` says (sheet.h)
};

}  // namespace voxtone::optics
