#!/bin/sh
# One would be sure that the reference library of 3MF, reading a valid file without a warning and writing it again, keeps which
# colour lies on a body. lib3mf 2.4.1 writes the groups of m:multiproperties (pids) by its own running numbers, and all other
# references by the file's ids. A body of base material 1 under colour group 3 (red), pids="1 3", is written with pids="1 2", and
# where another group has the id 2, here a blue one, the file is valid and the red body is blue; without one it is broken. Files
# whose ids happen to run 1, 2, 3 in the order of their groups survive, as most samples do. Coordinates are cut at 6 decimals, not
# rounded. For prints: a 3MF of layered colours that went through a tool built on lib3mf may be another one; look at its colours.
#   findings/lib3mf-multiproperties.sh     with npm, node and python3; seconds, 5 MB. 0: it is so; 1: it is not; 77: skipped
# With @3mfconsortium/lib3mf 2.4.1 of npm.
set -eu
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
npm --silent --prefix "$work" install @3mfconsortium/lib3mf@2.4.1 >/dev/null 2>&1 || { echo "skipped: no lib3mf 2.4.1 to be had from here"; exit 77; }
cat >"$work/file.py" <<'END'
# write FILE: a 3MF of one body. read FILE: the colour that its multiproperties give, and one coordinate.
import sys
import xml.etree.ElementTree as tree
import zipfile

core, material = ("http://schemas.microsoft.com/3dmanufacturing/" + x for x in ("core/2015/02", "material/2015/02"))
package = "http://schemas.openxmlformats.org/package/2006/"
kinds = "application/vnd.openxmlformats-package.relationships+xml", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
parts = {
    "[Content_Types].xml": f'<Types xmlns="{package}content-types"><Default Extension="rels" ContentType="{kinds[0]}"/>'
                           f'<Default Extension="model" ContentType="{kinds[1]}"/></Types>',
    "_rels/.rels": f'<Relationships xmlns="{package}relationships"><Relationship Target="/3D/3dmodel.model" Id="r" '
                   'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
    "3D/3dmodel.model": f'''<model unit="millimeter" xmlns="{core}" xmlns:m="{material}"><resources>
<basematerials id="1"><base name="white" displaycolor="#FFFFFF"/></basematerials>
<m:colorgroup id="3"><m:color color="#FF0000"/></m:colorgroup><m:colorgroup id="2"><m:color color="#0000FF"/></m:colorgroup>
<m:multiproperties id="4" pids="1 3"><m:multi pindices="0 0"/></m:multiproperties>
<object id="5" type="model" pid="4" pindex="0"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="7.7777779" y="0" z="0"/>
<vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/></triangles></mesh></object>
</resources><build><item objectid="5"/></build></model>'''}
if sys.argv[1] == "write":
    with zipfile.ZipFile(sys.argv[2], "w") as file:
        for name, text in parts.items():
            file.writestr(name, '<?xml version="1.0" encoding="UTF-8"?>' + text)
else:
    model = tree.fromstring(zipfile.ZipFile(sys.argv[2]).read("3D/3dmodel.model"))
    pids = model.find(f".//{{{material}}}multiproperties").get("pids")
    colours = {group.get("id"): group[0].get("color") for group in model.iter(f"{{{material}}}colorgroup")}
    print("pids", pids, "which is", colours.get(pids.split()[1], "nothing"), "x", model.findall(f".//{{{core}}}vertex")[1].get("x"))
END
cat >"$work/again.js" <<'END'
const fs = require('fs');
require('@3mfconsortium/lib3mf')().then(module => {
    const model = new module.CWrapper().CreateModel(), reader = model.QueryReader('3mf');
    module.FS.writeFile('/in.3mf', fs.readFileSync(process.argv[2]));
    reader.ReadFromFile('/in.3mf');
    if (reader.GetWarningCount() !== 0) throw new Error('warnings');
    model.QueryWriter('3mf').WriteToFile('/out.3mf');
    fs.writeFileSync(process.argv[3], module.FS.readFile('/out.3mf'));
}).catch(error => { console.log(String(error)); process.exitCode = 1; });
END
python3 "$work/file.py" write "$work/in.3mf"
node "$work/again.js" "$work/in.3mf" "$work/out.3mf"
before=$(python3 "$work/file.py" read "$work/in.3mf") after=$(python3 "$work/file.py" read "$work/out.3mf")
printf '%s\n' "before: $before" "after: $after"
if [ "$after" != "pids 1 2 which is #0000FFFF x 7.777777" ]; then
    echo "lib3mf writes the groups of multiproperties otherwise than it did"
    exit 1
fi
