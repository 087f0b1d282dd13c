#!/bin/sh
# One would be sure that OpenVDB, whose transforms may have another voxel size along each axis, either refuses to make a level set
# with such voxels or gives distances in millimetres. OpenVDB 10.0.1 takes the voxels of a printer (42.3 x 84.7 x 27 um), calls the
# grid a level set, says nothing, and gives distances counted in voxels times the voxel's size along x. The surface itself is in
# its place, so a look shows nothing; but the surface 0.1 mm outside a cube lies 0.100, 0.200 and 0.064 mm outside along x, y and z
# (wanted: 0.100 thrice), and another 0.100, 0.157 and 0.314 where the same printer's z is called x. For prints: shells, offsets
# and depths of colour made so are thick one way and thin another; make them with cubes as voxels and look them up.
#   findings/openvdb-print-voxels.sh     as root, with mmdebstrap; minutes, 250 MB. 0: it is so; 1: it is not; 77: skipped
# With python3-openvdb 10.0.1-2, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=python3-openvdb=10.0.1-2,libopenvdb10.0=10.0.1-2,python3-numpy bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/root/distances.py" <<'END'
import numpy
import pyopenvdb

corners = numpy.array([(x, y, z) for x in (0, 2) for y in (0, 2) for z in (0, 2)], dtype=numpy.float32)
sides = numpy.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)], dtype=numpy.uint32)
for voxel in (0.05, 0.05, 0.05), (0.0423, 0.0847, 0.027), (0.027, 0.0423, 0.0847):
    matrix = numpy.diag([*voxel, 1.0]).tolist()
    grid = pyopenvdb.FloatGrid.createLevelSetFromPolygons(
        corners, quads=sides, transform=pyopenvdb.createLinearTransform(matrix), halfWidth=5.0)
    surface, _ = grid.convertToQuads()
    outside, _ = grid.convertToQuads(isovalue=0.1)
    print("%s of %g x %g x %g: cube of" % (grid.gridClass, *voxel), *("%.3f" % e for e in numpy.ptp(surface, axis=0)),
          "grown by", *("%.3f" % g for g in outside.max(axis=0) - 2))
END
numbers=/usr/lib/x86_64-linux-gnu
LD_LIBRARY_PATH=$numbers/blas:$numbers/lapack chroot "$work/root" /usr/bin/python3 /distances.py >"$work/seen" 2>&1 ||
    { cat "$work/seen"; echo "OpenVDB makes no level set of such voxels any more"; exit 1; }
cat "$work/seen"
cat >"$work/wanted" <<'END'
level set of 0.05 x 0.05 x 0.05: cube of 2.000 2.000 2.000 grown by 0.100 0.100 0.100
level set of 0.0423 x 0.0847 x 0.027: cube of 2.000 2.000 2.000 grown by 0.100 0.200 0.064
level set of 0.027 x 0.0423 x 0.0847: cube of 2.000 2.000 2.000 grown by 0.100 0.157 0.314
END
cmp -s "$work/seen" "$work/wanted" || { echo "OpenVDB's distances in such voxels are others than they were"; exit 1; }
