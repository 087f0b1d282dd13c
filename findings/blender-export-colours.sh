#!/bin/sh
# One would be sure that one file of one program has one idea of what a number of a colour means, and that a cube of six painted
# sides keeps six colours. Blender 3.4.1 writes a grey of linear 0.2159 (code 128) into one OBJ twice: as 0.5019 beside the vertices,
# which is the code, and as Kd 0.215861 in its MTL, which is the linear number; whoever takes both for codes, as most do, shows the
# material at L* 23 for 54. And glTF gets colours of face corners mixed up: vertex i has corner i's, so that a cube with a red,
# green, blue, yellow, cyan and magenta side leaves as a red and green one with slanting borders; no message tells of either.
# For prints: materials without a texture come out far too dark, painted sides in others' colours. What helps: a texture instead of
# a material's colour, and colours of vertices instead of corners.
#   findings/blender-export-colours.sh     as root, with mmdebstrap and python3; many minutes, 1.2 GB. 0: it is so; 1: it is not; 77: skipped
# With blender 3.4.1+dfsg-2+b1, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=blender=3.4.1+dfsg-2+b1,python3-numpy bookworm "$work/root" http://deb.debian.org/debian ||
    { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/root/tmp/export.py" <<'END'
import bpy


def cube(kind, domain):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cube_add(size=0.02)
    mesh = bpy.context.object.data
    mesh.color_attributes.active_color = mesh.color_attributes.new(name="colour", type=kind, domain=domain)
    return mesh, mesh.color_attributes[0].data


grey = 0.2158605, 0.2158605, 0.2158605, 1
mesh, colours = cube("FLOAT_COLOR", "POINT")
material = bpy.data.materials.new("grey")
material.use_nodes = True
material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = grey
mesh.materials.append(material)
for point in colours:
    point.color = grey
bpy.ops.wm.obj_export(filepath="/tmp/grey.obj", export_colors=True, export_materials=True)
mesh, colours = cube("BYTE_COLOR", "CORNER")
for side, colour in zip(mesh.polygons, ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1))):
    for corner in side.loop_indices:
        colours[corner].color = (*colour, 1)
bpy.ops.export_scene.gltf(filepath="/tmp/sides.gltf", export_format="GLTF_EMBEDDED")
END
cat >"$work/colours.py" <<'END'
# The different COLOR_0 of FILE.gltf, and how many of its triangles have more than one.
import base64
import json
import struct
import sys

file = json.load(open(sys.argv[1], encoding="utf-8"))
data = base64.b64decode(file["buffers"][0]["uri"].split(",")[1])
part = file["meshes"][0]["primitives"][0]


def values(index, width):
    accessor = file["accessors"][index]
    start = file["bufferViews"][accessor["bufferView"]].get("byteOffset", 0)
    return list(struct.iter_unpack(f"<{width}H", data[start:start + 2 * width * accessor["count"]]))


colours = [tuple(round(c / 65535) for c in colour[:3]) for colour in values(part["attributes"]["COLOR_0"], 4)]
corners = [colours[i] for (i,) in values(part["indices"], 1)]
mixed = sum(len(set(corners[i:i + 3])) > 1 for i in range(0, len(corners), 3))
print("glTF: sides of", *sorted(set(colours)), "and", mixed, "of", len(corners) // 3, "triangles of several colours")
END
numbers=/usr/lib/x86_64-linux-gnu
HOME=/tmp LC_ALL=C.UTF-8 LD_LIBRARY_PATH=$numbers/blas:$numbers/lapack chroot "$work/root" \
    /usr/bin/blender --background --factory-startup --python /tmp/export.py >"$work/log" 2>&1 ||
    { tail "$work/log"; echo "Blender does not export any more"; exit 1; }
{
    echo "OBJ: vertices $(awk '$1 == "v" {print $5}' "$work/root/tmp/grey.obj" | sort -u), $(grep Kd "$work/root/tmp/grey.mtl")"
    python3 "$work/colours.py" "$work/root/tmp/sides.gltf"
} >"$work/seen"
cat "$work/seen"
cat >"$work/wanted" <<'END'
OBJ: vertices 0.5019, Kd 0.215861 0.215861 0.215861
glTF: sides of (0, 1, 0) (1, 0, 0) and 8 of 12 triangles of several colours
END
cmp -s "$work/seen" "$work/wanted" || { echo "Blender exports colours otherwise than it did"; exit 1; }
