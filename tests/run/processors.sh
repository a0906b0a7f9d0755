#!/usr/bin/env bash
# The same bits on processors with and without wide registers and fused multiplication and addition,
# which QEMU emulates: of the final state, of all histories and of all frames.
# Usage: processors.sh PROGRAM [COMMAND]: COMMAND is another program in place of this one under QEMU.
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

# Rigid bodies: quadrilaterals and crosses of a random fill fall onto each other, with friction and
# dashpots, in a region with its columns and roses. They spin, and are few enough to be tracked all.
# They begin close to the walls, as steps take long under QEMU.
hopper=(--set fill.0.count=12 --set 'fill.0.shapes=[{"quadrilateral":{}},{"cross":{}}]' --set 'fill.0.velocity=[0,-4]'
        --set 'fill.0.region=[[-0.15,0.25],[0.15,0.25],[0.55,0.7],[-0.55,0.7]]' --set fill.0.spin=3
        --set contact.normal_stiffness=1e8 --set 'regions={"bin":{"polygon":[[-0.8,0],[0.8,0],[0.8,2],[-0.8,2]]}}'
        --set output.history.interval=1e-4)
# Meshes: the same as finite elements that stiffen as a logarithm.
soft=("${hopper[@]}" --set 'materials.rock={"density":2000,"young":1e8,"poisson":0.2,"law":"neo_hookean"}'
      --set 'fill.0.mesh={"size":0.1,"element":"T3"}')
# Elements that touch by themselves, with damping of the material.
elements=("${hopper[@]}" --set 'materials.rock={"density":2000,"young":1e8,"poisson":0.2,"damping":{"model":"rayleigh","mass":1,"stiffness":1e-5}}'
          --set 'fill.0.mesh={"size":0.1,"element":"Q4"}' --set contact.surface=element)
# Crosses by the distance from their boundaries in place of their roofs, with a friction spring for
# each edge, dashpots along the normal, and damping of the whole motion.
distance=("${hopper[@]}" --set contact.field=distance --set 'contact.friction={"coefficient":0.5,"law":"per_edge"}'
          --set 'contact.damping=[{"model":"normal_viscous","ratio":0.2},{"model":"mass","rate":1}]')
declare -A until=([hopper]=0.08 [soft]=0.02 [elements]=0.02 [distance]=0.06)

# Systems of equations: implicit steps of rigid blocks, and static meshes with and without friction.
stack=(--until 0.4)
wedge=(--until 0.1)
pressed=()
declare -A own=([stack]=scenes/stack.json [wedge]=scenes/wedge.json [pressed]=scenes/pressed-blocks.json)

results() { # PROGRAM FOLDER SCENE ARGUMENTS
  local on=$1 to=$2 scene=$3
  shift 3
  $on run "$data/${own[$scene]:-studies/hopper-fill.json}" "$@" -o "$to" --quiet || return 1
  grep -o '"final_state_hash": *"[^"]*"' "$to/run.json"
}
compared() { (cd "$1" && find . -name '*.csv' -o -name '*.pvd' -o -name '*.vtu' | sort); }
for scene in hopper soft elements distance stack wedge pressed; do
  declare -n arguments=$scene
  [ -z "${until[$scene]:-}" ] || arguments+=(--until "${until[$scene]}")
  expected=$(results here $scene $scene "${arguments[@]}")
  [ -n "${own[$scene]:-}" ] ||
    python3 -c 'import json, sys; assert json.load(open(sys.argv[1]))["pairs_per_step"]["touching"] > .4' $scene/run.json
  for other in "${others[@]}"; do
    there=$(results $other $scene-$other $scene "${arguments[@]}")
    echo "$scene, $other: $there"
    [ "$expected" = "$there" ] || { echo "this processor: $expected"; exit 1; }
    [ "$(compared $scene)" = "$(compared $scene-$other)" ] || { echo "$scene, $other: other files"; exit 1; }
    for file in $(compared $scene); do cmp "$scene/$file" "$scene-$other/$file"; done
  done
done
