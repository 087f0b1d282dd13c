#!/bin/sh
# One would be sure that code for CGAL's alpha wrap which compiles with 6.0 as with 5.5 is watched there, too. The visitor, by
# which alone a wrap can be counted, bounded and stopped, is looked for among the output's named parameters by 5.5.1 and among
# the input's by 6.0.1; where it stands in the other place nobody calls it, and neither compiler nor library says a word. A ball
# that inserts some 230 points calls it as often from the right place and never from the wrong one. For prints: a repair
# that was bounded on Debian 12 runs without end on Debian 13; pass the visitor in both, which both take.
#   findings/cgal-wrap-visitor.sh     as root, with mmdebstrap and g++; two minutes, 60 MB. 0: it is so; 1: it is not; 77: skipped
# With libcgal-dev 5.5.1-2 (bookworm) and 6.0.1-1 (trixie), on amd64.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
cat >"$work/watch.cpp" <<'END'
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
struct Watch : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
    long points = 0;
    template <class Wrapper, class Vertex>
    void after_Steiner_point_insertion(const Wrapper&, Vertex) { ++points; }
};
int main() {
    std::vector<Point> points;
    std::vector<std::array<std::size_t, 3>> faces;
    const int rings = 12, around = 24;
    const double pi = 3.14159265358979323846;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < around; ++j)
            points.emplace_back(std::sin(pi * i / rings) * std::cos(2 * pi * j / around),
                                std::sin(pi * i / rings) * std::sin(2 * pi * j / around), std::cos(pi * i / rings));
    for (std::size_t i = 0; i < rings; ++i)
        for (std::size_t j = 0; j < around; ++j) {
            const std::size_t a = i * around + j, b = i * around + (j + 1) % around, c = a + around, d = b + around;
            if (i > 0) faces.push_back({a, c, b});
            if (i + 1 < rings) faces.push_back({b, c, d});
        }
    Watch input, output;
    CGAL::Surface_mesh<Point> mesh;
    CGAL::alpha_wrap_3(points, faces, 0.4, 0.02, mesh, CGAL::parameters::visitor(std::ref(input)),
                       CGAL::parameters::visitor(std::ref(output)));
    std::printf("%s: a wrap of %d points; visitor of the input %ld, of the output %ld\n", SAID_VERSION,
                int(mesh.number_of_vertices()), input.points, output.points);
}
END
watch() { # SYSTEM VERSION
    mmdebstrap --quiet --variant=extract --include="libcgal-dev=$2" "$1" "$work/$1" http://deb.debian.org/debian >"$work/log" 2>&1 ||
        { cat "$work/log"; echo "skipped: no Debian ($1) to be had from here"; exit 77; }
    # Both with the older system's numbers: the newer one's want its C library.
    [ -d "$work/lib" ] || { mkdir "$work/lib" && cp "$work/$1"/usr/lib/x86_64-linux-gnu/lib[gm][mp][pf]*.so.[0-9]* "$work/lib/"; }
    g++ -std=c++17 -O1 -w -DSAID_VERSION="\"CGAL $2\"" -isystem "$work/$1/usr/include" -isystem "$work/$1/usr/include/x86_64-linux-gnu" \
        "$work/watch.cpp" -o "$work/watch-$1" "$work/lib/libmpfr.so.6" "$work/lib/libgmp.so.10" || { echo "skipped: it does not compile"; exit 77; }
    LD_LIBRARY_PATH=$work/lib "$work/watch-$1" | tee "$work/$1.seen"
}
watch bookworm 5.5.1-2
watch trixie 6.0.1-1
awk '{print ($(NF - 4) + 0 > 0) ":" ($NF + 0 > 0)}' "$work/bookworm.seen" "$work/trixie.seen" | tr '\n' ' ' | grep -qx '0:1 1:0 ' ||
    { echo "the visitor is looked for elsewhere than it was"; exit 1; }
