#!/usr/bin/env bash
# The tables of the shipped studies, from small runs of them: they agree with those of `apothem sweep`.
set -euo pipefail
command -v python3 >/dev/null || exit 77
program=$(realpath "$1")
# A python3 that chooses among versions takes longer for it than for most of what follows.
python=$(python3 -c 'import sys; print(sys.executable)')
python3() { "$python" "$@"; }
studies=$(cd "$(dirname "$0")/../../data/studies" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "$1"; exit 1; }
tables() { python3 "$studies/tables.py" "$@"; }

small=(--set fill.0.count=80 --set contact.normal_stiffness=2e6 --quiet --jobs 2)
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

# The shipped counts are those of the runs that are kept; Wilson's intervals, and an exact test whose values are known.
python3 "$studies/counts.py" collect | diff - "$studies/results/hopper.csv" || fail "results/hopper.csv is not what counts.py collect prints"
python3 "$studies/counts.py" table friction | tee counts.txt
grep -Eq '2e9 \| 7 \| 13 of 20: 0.65 \(0.43 to 0.82\) .* 41 of 60: 0.68 \(0.56 to 0.79\) \| 0.79 ' counts.txt ||
  fail "the counts have another interval or test"
python3 - "$studies" <<'TEST' || fail "Fisher's test has another value"
import sys
sys.path.insert(0, sys.argv[1])
import tables
assert abs(tables.fisher(3, 4, 1, 4) - 34 / 70) < 1e-15 and tables.fisher(3, 10, 3, 10) == 1  # Fisher's own example: tea and milk
TEST

# A study by its name: a shard, what is recorded of it, and one of its runs again.
cp -r "$studies" here
python3 - <<'TEST'
import json
few = {"counted as": {"shape": "quad"}, "widths": [9], "seeds": 2,
       "set": {"fill.0.count": "40", "contact.normal_stiffness": "1e7", "time.end": "3"}}
json.dump({"few": few}, open("here/results/studies.json", "w"))
TEST
export APOTHEM_PROGRAM="$program"
python3 here/study.py make few --shard 2/2 -o few
python3 here/study.py record few -o few
[ "$(grep -c done here/results/few.csv)" = 1 ] || fail "not the one run of the shard is recorded"
python3 here/study.py repeat few 9 2 | tee repeat.txt
grep -q 'the same bits' repeat.txt || fail "a run that is made again has other bits"
hash=$(grep -o 'final_state_hash  kept [^ ]*' repeat.txt | cut -d' ' -f4)
sed -i "s/$hash/fnv1a64:0/" here/results/few.csv
! python3 here/study.py repeat few 9 2 || fail "a changed hash is not seen"

# All jams are in one window of blocks.
tables hazard flow | tee hazard.txt
jams=$(awk -F, 'NR > 1 { n += $6 } END { print n }' flow/summary.csv)
found=$(grep -o '([0-9]*)' hazard.txt | tr -d '()' | awk '{ n += $1 } END { print n + 0 }')
[ "$jams" -gt 0 ] && [ "$jams" = "$found" ] || fail "$jams jams, $found in the windows"

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
