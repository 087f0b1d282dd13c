#!/bin/sh
# Many parts in one print: six models, two patches of a mixture and twenty tags, each with its number, laid beside each other. The same command again does
# nothing.
set -eu
voxtone=${VOXTONE:-build/release/bin/voxtone}
out=${OUT:-out}/13-tray
here=$(dirname "$0")
"$voxtone" tray "$here/13-tray.json" --gap 2mm --overwrite -o "$out"
"$voxtone" tray "$here/13-tray.json" --gap 2mm -o "$out" --quiet
"$voxtone" verify "$out"
