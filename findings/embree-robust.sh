#!/bin/sh
# One would be sure that a ray from inside a closed mesh meets it, surely so with the flag that is called robust. In Embree
# 3.13.5, of rays from a point in a closed ball of 14,160 triangles to points on its 21,240 edges 2,285 come out without a hit,
# and of those to its 7,082 corners 243; with RTC_SCENE_FLAG_ROBUST none through an edge, but 23 still through a corner. That is
# with max_isa=sse2; with the AVX2 that most processors get it is 2,119 and 1,954, and 0 and 57: the same file finds other holes
# on another processor. Of 100,000 rays at random none slips through in any. For prints: what aims rays at a mesh's own corners
# and edges (what is seen from a corner, how thick it is there, inside or outside) finds holes in a whole body; ask for robust,
# and even then take no miss for an opening, but ask again beside it.
#   findings/embree-robust.sh     as root, with mmdebstrap and gcc; a minute, 80 MB. 0: it is so; 1: it is not; 77: skipped
# With libembree3-3 3.13.5+dfsg-2, on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
mmdebstrap --quiet --variant=extract --include=libembree3-3=3.13.5+dfsg-2,libembree-dev=3.13.5+dfsg-2 bookworm "$work/root" \
    http://deb.debian.org/debian || { echo "skipped: no Debian (bookworm) to be had from here"; exit 77; }
cat >"$work/rays.c" <<'END'
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
enum { rings = 60, around = 2 * rings, corners = (rings - 1) * around + 2, faces = 2 * (rings - 1) * around };
static const double pi = 3.14159265358979323846;
static float *place;
static unsigned *face;
static unsigned corner(int ring, int step) {
    return ring == 0 ? 0 : ring == rings ? corners - 1 : 1 + (unsigned)((ring - 1) * around + step % around);
}
/* Numbers in [0, 1), the same everywhere. */
static double any(void) {
    static unsigned long long state = 1;
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 11) / 9007199254740992.0;
}
static int slips(RTCScene scene, double x, double y, double z) {
    struct RTCRayHit ray = {{0}};
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    ray.ray.org_x = 1.3f, ray.ray.org_y = -2.1f, ray.ray.org_z = 0.7f;
    ray.ray.dir_x = (float)(x - ray.ray.org_x), ray.ray.dir_y = (float)(y - ray.ray.org_y), ray.ray.dir_z = (float)(z - ray.ray.org_z);
    ray.ray.tfar = 1e30f, ray.ray.mask = ~0u, ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID;
}
static void try(const char *name, enum RTCSceneFlags flags) {
    RTCDevice device = rtcNewDevice("max_isa=sse2,threads=1");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry ball = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSceneFlags(scene, flags);
    place = rtcSetNewGeometryBuffer(ball, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corners);
    face = rtcSetNewGeometryBuffer(ball, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, faces);
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < around; ++j) {
            float *p = place + 3 * corner(i, j);
            const double down = pi * i / rings, turn = pi * j / rings;
            p[0] = (float)(10 * sin(down) * cos(turn)), p[1] = (float)(10 * sin(down) * sin(turn)), p[2] = (float)(10 * cos(down));
        }
    unsigned *f = face;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < around; ++j) {
            const unsigned a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
            if (i < rings - 1) *f++ = a, *f++ = b, *f++ = c;
            if (i > 0) *f++ = a, *f++ = c, *f++ = d;
        }
    rtcCommitGeometry(ball);
    rtcAttachGeometry(scene, ball);
    rtcCommitScene(scene);
    int edges = 0, by_edge = 0, by_corner = 0, by_chance = 0;
    for (int k = 0; k < 3 * faces; ++k) {
        const float *p = place + 3 * face[k], *q = place + 3 * face[k % 3 == 2 ? k - 2 : k + 1];
        if (p > q) continue;
        const double w = any();
        ++edges;
        by_edge += slips(scene, p[0] * w + q[0] * (1 - w), p[1] * w + q[1] * (1 - w), p[2] * w + q[2] * (1 - w));
    }
    for (int k = 0; k < corners; ++k) by_corner += slips(scene, place[3 * k], place[3 * k + 1], place[3 * k + 2]);
    for (int k = 0; k < 100000; ++k) by_chance += slips(scene, 20 * any() - 10, 20 * any() - 10, 20 * any() - 10);
    printf("%s: of %d edges %d, of %d corners %d, at random %d let a ray out\n", name, edges, by_edge, corners, by_corner, by_chance);
    rtcReleaseGeometry(ball), rtcReleaseScene(scene), rtcReleaseDevice(device);
}
int main(void) {
    try("plain", RTC_SCENE_FLAG_NONE);
    try("robust", RTC_SCENE_FLAG_ROBUST);
    return 0;
}
END
libraries=$work/root/usr/lib/x86_64-linux-gnu
gcc -O1 -I "$work/root/usr/include" "$work/rays.c" -o "$work/root/rays" "$libraries/libembree3.so.3" -lm -Wl,--allow-shlib-undefined ||
    { echo "skipped: no gcc"; exit 77; }
chroot "$work/root" /rays | tee "$work/seen"
awk '/^plain/ {plain = $5 / $3 > 0.05 && $9 > 0 && $12 == 0} /^robust/ {robust = $5 == 0 && $9 > 0 && $12 == 0}
    END {exit !(plain && robust)}' FS='[ ,]+' "$work/seen" || { echo "Embree's rays slip through a closed mesh otherwise than they did"; exit 1; }
