#!/usr/bin/env bash
# The same bits on processors with and without wide registers and fused multiplication and addition,
# which QEMU emulates. Usage: processors.sh PROGRAM [COMMAND]: COMMAND is another program in place of this one under QEMU.
# Exit code 77: there is no QEMU (package qemu-user).
set -euo pipefail
command -v qemu-x86_64 >/dev/null && [ "$(uname -m)" = x86_64 ] || exit 77
program=$(realpath "$1")
command=${2:-}
here() { "$program" "$@"; }
nehalem() { qemu-x86_64 -cpu Nehalem "$program" "$@"; }
all_features() { qemu-x86_64 -cpu max "$program" "$@"; }
emulated() { $command "$@"; }
others=(nehalem all_features)
[ -z "$command" ] || others=(emulated)
data=$(cd "$(dirname "$0")/../../data" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# Rigid bodies: quadrilaterals and crosses of a random fill fall onto each other, with friction and damping.
hopper=(--set fill.0.count=24 --set 'fill.0.shapes=[{"quadrilateral":{}},{"cross":{}}]' --set 'fill.0.velocity=[0,-4]'
        --set 'fill.0.region=[[-0.7,0.82],[0.7,0.82],[0.7,1.8],[-0.7,1.8]]'
        --set contact.normal_stiffness=1e8)
# Meshes: the same as finite elements that stiffen as a logarithm.
soft=("${hopper[@]}" --set 'materials.rock={"density":2000,"young":1e8,"poisson":0.2,"law":"neo_hookean"}'
      --set 'fill.0.mesh={"size":0.1,"element":"T3"}')
# Crosses by the distance from their boundaries in place of their roofs.
distance=("${hopper[@]}" --set contact.field=distance)
declare -A until=([hopper]=0.4 [soft]=0.16 [distance]=0.2)

hash_of() { # PROGRAM NAME ARGUMENTS
  local on=$1 name=$2
  shift 2
  rm -rf "$name"
  $on run "$data/studies/hopper-fill.json" "$@" -o "$name" --quiet || return 1
  grep -o '"final_state_hash": *"[^"]*"' "$name/run.json"
}
for scene in hopper soft distance; do
  declare -n arguments=$scene
  arguments+=(--until "${until[$scene]}")
  expected=$(hash_of here $scene "${arguments[@]}")
  python3 -c 'import json, sys; assert json.load(open(sys.argv[1]))["pairs_per_step"]["touching"] > .1' $scene/run.json
  for other in "${others[@]}"; do
    there=$(hash_of $other $scene "${arguments[@]}")
    echo "$scene, $other: $there"
    [ "$expected" = "$there" ] || { echo "this processor: $expected"; exit 1; }
  done
done
