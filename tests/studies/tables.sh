#!/usr/bin/env bash
# The tables of the shipped studies, from small runs of them: they agree with those of `apothem sweep`.
set -euo pipefail
command -v python3 >/dev/null || exit 77
program=$(realpath "$1")
studies=$(cd "$(dirname "$0")/../../data/studies" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "$1"; exit 1; }
tables() { python3 "$studies/tables.py" "$@"; }

small=(--set fill.0.count=80 --set contact.normal_stiffness=1e7 --quiet --jobs 2)
"$program" sweep "$studies/hopper-fill.json" "${small[@]}" --vary fill.0.seed=1..4 -o fill
grep -E '^(#|5,|9,|10,|11,)' "$studies/hopper-widths.csv" >widths.csv
"$program" sweep "$studies/hopper-flow.json" "${small[@]}" --table widths.csv --vary fill.0.seed=1..4 --from fill -o flow

# Jams per width, and Wilson's intervals.
tables jam flow --reference quad,0.5 | tee jam.txt
awk -F, 'NR > 1 { printf "%g %d/%d %.2f (%.2f to %.2f)\n", $1, $6, $4, $7, $8, $9 }' flow/summary.csv | sort >expected.txt
awk 'NR > 1 { print $1, $2, $3, $4, $5, $6 }' jam.txt | sort >found.txt
diff expected.txt found.txt || fail "the jams are not those of the summary"
[ "$(wc -l <found.txt)" = 4 ] || fail "a width is missing"

# A study against itself.
tables pairs flow flow | tee pairs.txt
awk 'NR > 1 && ($3 != 0 || $4 != 0 || $6 != 1) { exit 1 }' pairs.txt || fail "a study differs from itself"

# What is recorded of a study says the same as its folder.
tables record flow recorded
tables jam recorded.csv --reference quad,0.5 | diff jam.txt - || fail "the recorded study has other jams"
tables hazard recorded.csv | diff <(tables hazard flow) - || fail "the recorded study has other hazards"

# The shipped counts: Wilson's intervals, and an exact test whose value is known (6 of 20 against 41 of 60).
tables counts "$studies/results/hopper.csv" | tee counts.txt
grep -Eq '^quad +0.5 +- +2e8 +0.2 +7 +6/20 .*0.30 \(0.15 to 0.52\).* 41/60 .* 0.004$' counts.txt || fail "the counts have another interval or test"

# All jams are in one window of blocks.
tables hazard flow | tee hazard.txt
jams=$(awk -F, 'NR > 1 { n += $6 } END { print n }' flow/summary.csv)
found=$(grep -o '([0-9]*)' hazard.txt | tr -d '()' | awk '{ n += $1 } END { print n + 0 }')
[ "$jams" = "$found" ] || fail "$jams jams, $found in the windows"

tables beverloo flow | tee beverloo.txt
grep -q '^C = ' beverloo.txt || fail "no fit"

# The resting blocks of a run, as a drawing that can be meshed.
tables outlines fill drawings
[ "$(grep -c POLYGON drawings/2.wkt)" = 80 ] || fail "not every block is in the drawing"
"$program" check "$studies/soft-fill.json" --set import.0.file="$PWD/drawings/2.wkt" | tee soft.txt
grep -q '80 deformable' soft.txt || fail "the drawing was not meshed"

if command -v gnuplot >/dev/null; then
  tables picture jam.png "some blocks"=flow --reference quad,0.5 --width 9
  head -c 8 jam.png | grep -q PNG || fail "no picture"
fi

# 12 blocks in the trough.
"$program" sweep "$studies/pack.json" --quiet --table <(printf '#blocks,fill.0.count\n12,12\n24,24\n') --set time.end=0.05 -o pack
tables cost pack | tee cost.txt
[ "$(awk '$3 > 0' cost.txt | wc -l)" = 3 ] || fail "no cost"

"$program" sweep "$studies/repose-fill.json" "${small[@]}" --vary fill.0.seed=1..2 -o repose-fill
"$program" sweep "$studies/repose.json" "${small[@]}" --vary fill.0.seed=1..2 --from repose-fill -o repose
tables repose repose | tee repose.txt
grep -q '^angle of repose ' repose.txt || fail "no angle"
