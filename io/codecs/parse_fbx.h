// SPDX-License-Identifier: GPL-3.0-or-later
//
// FBX from 7000 on, binary or text (io/scenes/fbx_tree.h): meshes where their models stand (io/scenes/fbx_transform.h),
// turned from the file's axes to z up; its unit is in cm.
//
// Colour of a face: its material's texture on DiffuseColor, or on what other shaders call it, from within the file or
// beside it, by the coordinates that the texture names; where there is none, colours of the mesh that are not all
// white; else DiffuseColor times its factor, or EmissiveColor where that is black. They are not multiplied. All are
// sRGB codes, but for material colours that Blender wrote: these are linear.
//
// Models are taken in the pose that the file stores, meshes before skins and blend shapes; animations and hidden models
// are left aside, of levels of detail the first is taken, which is said. Surfaces that are no meshes (NURBS, patches)
// refuse the file by name.
#pragma once

#include "io/codecs/parse_context.h"

namespace voxtone::io {

[[nodiscard]] ModelParts parse_fbx(ParseContext& context);

}  // namespace voxtone::io
