#!/bin/sh
# Runs what is in this folder on the real thing: GNU parallel, openjd-cli, Slurm. Each must give the bytes of one run on one machine, a third
# of its shares killed on the way. What is not installed is skipped, and told.
#
#   farm/test.sh [PROGRAM]        (openjd from PyPI: openjd-cli; Debian: parallel, slurm-wlm; Slurm needs root)
#
# Ends with 0 if nothing that could be run failed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$(command -v focus-brush || echo "$here/../target/debug/focus-brush")}
program=$(readlink -f "$program")
[ -x "$program" ] || { echo "error: $program: not there (build it first, or name it)" >&2; exit 3; }
work=$(mktemp -d)
export XDG_CACHE_HOME="$work/cache" FOCUS_BRUSH="$program" RAYON_NUM_THREADS=1
project="${FARM_TEST_PROJECT:-$here/../assets/demo/demo.fbrush}"
project=$(readlink -f "$project")
frames=${FARM_TEST_FRAMES:-1-12}
size=${FARM_TEST_SIZE:-96x54}
failed=0
cat >"$work/keys.json" <<KEYS
{"focus": [{"seconds": 0, "value": {"distance": 0.5}}, {"seconds": 0.45, "value": {"distance": 2.0}}]}
KEYS

# same NAME: whether the pictures of a farm are those of one machine.
same() {
    for file in "$work"/one/*.exr; do
        cmp "$file" "$work/$1/$(basename "$file")" || { echo "FAILED $1"; failed=1; return; }
    done
    [ "$(ls -A "$work/$1" | grep -c .)" = "$(ls "$work/one" | grep -c .)" ] || { echo "FAILED $1: files that nobody asked for"; failed=1; return; }
    echo "passed $1"
}

# kill_some COUNT: ends so many of our runs, one after the other, as a farm would.
kill_some() {
    for _ in $(seq "$1"); do
        sleep 2
        pid=$(pgrep --full --oldest "^$program render $project" || true)
        [ -n "$pid" ] && kill -TERM "$pid" 2>/dev/null
    done
}

mkdir "$work/one"
"$program" render "$project" --frames "$frames" --size "$size" --keys "$work/keys.json" -o "$work/one/f.####.exr" 2>"$work/one.log" || {
    tail -1 "$work/one.log" >&2
    exit 3
}

if command -v parallel >/dev/null; then
    for shares in 1 2 7 64; do
        mkdir "$work/parallel-$shares"
        kill_some $((shares < 7 ? 1 : 3)) &
        killer=$!
        PARALLEL_OPTIONS="--jobs 4 --retries 4 --will-cite" "$here/frames.parallel.sh" "$shares" "$project" "$frames" \
            "$work/parallel-$shares/f.####.exr" --size "$size" --keys "$work/keys.json" 2>"$work/parallel-$shares.log"
        wait $killer
        same "parallel-$shares"
    done
else
    echo "SKIPPED parallel: not installed (apt install parallel)"
fi

if command -v openjd >/dev/null; then
    mkdir "$work/openjd"
    run_openjd() {
        openjd run "$here/frames.openjd.yaml" --step Frames -p "Project=$project" -p "Frames=$frames" \
            -p "Output=$work/openjd/f.####.exr" -p "Program=$program" -p "Arguments=--size $size --keys $work/keys.json"
    }
    kill_some 1 &
    killer=$!
    run_openjd >"$work/openjd.log" 2>&1 || echo "openjd: a task was ended, as it should be"
    wait $killer
    run_openjd >>"$work/openjd.log" 2>&1 || { tail -5 "$work/openjd.log"; }
    same openjd
else
    echo "SKIPPED openjd: not installed (pip install openjd-cli)"
fi

if command -v slurmctld >/dev/null && command -v munged >/dev/null && [ "$(id -u)" = 0 ]; then
    slurm="$work/slurm-state"
    if "$here/slurm_on_one_machine.sh" start "$slurm"; then
        export SLURM_CONF="$slurm/slurm.conf"
        for shares in 2 7; do
            mkdir "$work/slurm-$shares"
            submit() {
                sbatch --wait --array="1-$shares" --output="$work/slurm-$shares-%a.log" --chdir="$work" \
                    "$here/frames.sbatch" "$project" "$frames" "$work/slurm-$shares/f.####.exr" \
                    --size "$size" --keys "$work/keys.json"
            }
            (sleep 4; scancel --signal=TERM --batch "$(squeue --noheader --format %A --states R | head -1)" 2>/dev/null) &
            killer=$!
            submit >/dev/null || echo "slurm: a share was ended, as it should be"
            wait $killer
            submit >/dev/null || { cat "$work"/slurm-$shares-*.log | tail -5; }
            same "slurm-$shares"
        done
    else
        failed=1
    fi
    "$here/slurm_on_one_machine.sh" stop "$slurm"
else
    echo "SKIPPED slurm: not installed, or not root (apt install slurm-wlm)"
fi

[ "$failed" = 0 ] && rm -rf "$work" || echo "what was written is in $work"
exit "$failed"
