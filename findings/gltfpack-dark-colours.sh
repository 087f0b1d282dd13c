#!/bin/sh
# One would be sure that 8 bits a colour are enough, as in any picture, and that gltfpack's -noq ("disable quantization") leaves
# floats as they are. Vertex colours of glTF are linear light, and gltfpack 1.3.0 stores them in 8 bits of that: of the 26 darkest
# greys of sRGB (codes 0 to 25, each a colour of its own in the file that goes in) 3 are left, 0, 13 and 22, which are 3.5 L*
# apart; greys are off by up to 1.7, and code 6 is as black as 0. With -noq it is the same, and positions stay floats; -vc 12 keeps
# all 26. For prints: shadows of a scan with vertex colours come out in bands, where a texture of 8 bits would not.
#   findings/gltfpack-dark-colours.sh     with npm and node; seconds, 1 MB. 0: it is so; 1: it is not; 77: skipped
# With gltfpack 1.3.0 of npm.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
npm --silent --prefix "$work" install gltfpack@1.3.0 >/dev/null 2>&1 || { echo "skipped: no gltfpack 1.3.0 to be had from here"; exit 77; }
cat >"$work/greys.js" <<'END'
// write FILE: squares of 1 mm, one of each grey as COLOR_0 in floats. read FILE: the different greys in it as codes of sRGB.
const fs = require('fs');
const linear = c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
const code = y => 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055);
const [, , verb, file] = process.argv;
if (verb === 'write') {
    const places = [], colours = [], corners = [];
    for (let grey = 0; grey < 26; ++grey) {
        for (const [x, y] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
            places.push((grey + x) / 1000, y / 1000, 0);
            colours.push(...Array(3).fill(linear(grey / 255)));
        }
        corners.push(...[0, 1, 2, 0, 2, 3].map(corner => 4 * grey + corner));
    }
    const parts = [Float32Array.from(places), Float32Array.from(colours), Uint32Array.from(corners)].map(a => Buffer.from(a.buffer));
    let at = 0;
    const bufferViews = parts.map(part => ({buffer: 0, byteOffset: (at += part.length) - part.length, byteLength: part.length}));
    fs.writeFileSync(file, JSON.stringify({
        asset: {version: '2.0'}, scene: 0, scenes: [{nodes: [0]}], nodes: [{mesh: 0}], bufferViews,
        meshes: [{primitives: [{attributes: {POSITION: 0, COLOR_0: 1}, indices: 2}]}],
        accessors: [{bufferView: 0, componentType: 5126, count: 104, type: 'VEC3', min: [0, 0, 0], max: [0.026, 0.001, 0]},
            {bufferView: 1, componentType: 5126, count: 104, type: 'VEC3'}, {bufferView: 2, componentType: 5125, count: 156, type: 'SCALAR'}],
        buffers: [{byteLength: at, uri: 'data:application/octet-stream;base64,' + Buffer.concat(parts).toString('base64')}]}));
} else {
    const glb = fs.readFileSync(file), size = glb.readUInt32LE(12), json = JSON.parse(glb.subarray(20, 20 + size)), seen = new Set();
    const accessor = json.accessors[json.meshes[0].primitives[0].attributes.COLOR_0], view = json.bufferViews[accessor.bufferView];
    const wide = accessor.componentType === 5123, start = 28 + size + (view.byteOffset || 0) + (accessor.byteOffset || 0);
    for (let i = 0; i < accessor.count; ++i) {
        const place = start + i * view.byteStride;
        seen.add(code(wide ? glb.readUInt16LE(place) / 65535 : glb[place] / 255).toFixed(wide ? 1 : 0));
    }
    console.log(seen.size + ': ' + [...seen].sort((a, b) => a - b).join(' '));
}
END
pack() {
    name=$1
    shift
    node "$work/node_modules/gltfpack/cli.js" -i "$work/greys.gltf" -o "$work/$name.glb" "$@" && node "$work/greys.js" read "$work/$name.glb"
}
node "$work/greys.js" write "$work/greys.gltf"
plain=$(pack plain) noq=$(pack noq -noq) twelve=$(pack twelve -vc 12)
printf '%s\n' "greys left: $plain" "with -noq: $noq" "with -vc 12: $twelve"
if [ "$plain" != "3: 0 13 22" ] || [ "$noq" != "$plain" ] || [ "${twelve%%:*}" != 26 ]; then
    echo "gltfpack keeps dark vertex colours otherwise than it did"
    exit 1
fi
