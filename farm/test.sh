#!/bin/sh
# Runs what is in this folder on the real thing: GNU parallel, openjd-cli, Slurm. Each must give the bytes of one run on one machine, a third
# of the shares that have something to do killed at random moments and started again. What is not installed is skipped, and told.
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
export XDG_CACHE_HOME="$work/cache" RAYON_NUM_THREADS=1
export FARM_PROGRAM="$program" FOCUS_BRUSH="$here/killed_once.sh" PARALLEL_OPTIONS="--jobs 4 --retries 4 --will-cite"
project=$(readlink -f "${FARM_TEST_PROJECT:-$here/../assets/demo/demo.fbrush}")
frames=${FARM_TEST_FRAMES:-1-12}
moving="--size ${FARM_TEST_SIZE:-96x54} --keys $work/keys.json"
still="--size ${FARM_TEST_TILED_SIZE:-480x270}"
failed=0
cat >"$work/keys.json" <<KEYS
{"focus": [{"seconds": 0, "value": {"distance": 0.5}}, {"seconds": 0.45, "value": {"distance": 2.0}}]}
KEYS

# one NAME OPTIONS…: makes what a farm must give, in a folder of that name. Light that is kept from the first time is there the second,
# which is timed.
one() {
    name=$1
    shift
    for _ in first second; do
        began=$(date +%s)
        rm -rf "$work/$name"
        mkdir "$work/$name"
        "$program" render "$project" "$@" 2>"$work/$name.log" || { tail -1 "$work/$name.log" >&2; exit 3; }
        seconds=$(($(date +%s) - began))
    done
}

# begin NAME SHARES PIECES: of so many shares no more are busy than there are frames or tiles, and a third of these is killed, rounded up.
begin() {
    mkdir "$work/$1"
    busy=$2
    [ "$busy" -le "$3" ] || busy=$3
    FARM_STATE="$work/$1-state"
    FARM_KILLS=$(((busy + 2) / 3))
    FARM_SPAN=$(awk -v all="$seconds" -v busy="$busy" 'BEGIN { print 0.7 * all / busy }')
    export FARM_STATE FARM_KILLS FARM_SPAN
}

# merge NAME: the picture of the tiles that are there, instead of their parts.
merge() {
    "$program" merge -o "$work/$1/big.exr" "$work/$1"/big.tile*.part 2>"$work/$1-merge.log" || tail -1 "$work/$1-merge.log"
    rm -f "$work/$1"/big.tile*.part
}

# same ONE NAME: whether what is in NAME is what ONE has, and as many shares died as should.
same() {
    died=$(ls "$FARM_STATE/killed" | grep -c .)
    if ! diff -r "$work/$1" "$work/$2"; then
        echo "FAILED $2: not the files of one machine"
    elif [ "$died" != "$FARM_KILLS" ]; then
        echo "FAILED $2: $died shares were killed, not $FARM_KILLS"
    else
        echo "passed $2 ($died of $busy busy shares killed)"
        return
    fi
    failed=1
}

# submit NAME SHARES SCRIPT ARGUMENTS…: an array of Slurm, and once more for what was killed of it.
submit() {
    name=$1 shares=$2 script=$3
    shift 3
    for _ in first again; do
        sbatch --wait --array="1-$shares" --output="$work/$name-%a.log" --chdir="$work" "$here/$script" "$project" "$@" \
            >"$work/$name.log" && return
    done
    tail -n 1 "$work/$name"-*.log
}

# $moving and $still are words.
one tiles $still -o "$work/tiles/big.exr"
of_tiles=$seconds
one frames --frames "$frames" $moving -o "$work/frames/f.####.exr"
pictures=$(ls "$work/frames" | grep -c .)
of_frames=$seconds

if command -v parallel >/dev/null; then
    for shares in 1 2 7 64; do
        seconds=$of_frames name=parallel-$shares
        begin "$name" "$shares" "$pictures"
        "$here/frames.parallel.sh" "$shares" "$project" "$frames" "$work/$name/f.####.exr" $moving 2>"$work/$name.log"
        same frames "$name"
        seconds=$of_tiles name=parallel-tiles-$shares
        begin "$name" "$shares" 16
        "$here/tiles.parallel.sh" "$shares" "$project" 4x4 "$work/$name/big.exr" $still 2>"$work/$name.log"
        merge "$name"
        same tiles "$name"
    done
else
    echo "SKIPPED parallel: not installed (apt install parallel)"
fi

if command -v openjd >/dev/null; then
    for shares in 1 2 7 64; do
        seconds=$of_frames name=openjd-$shares
        chunk=$(((pictures + shares - 1) / shares))
        begin "$name" $(((pictures + chunk - 1) / chunk)) "$pictures"
        # A task that fails ends the run of openjd-cli; what is finished stays.
        for _ in $(seq "$FARM_KILLS") last; do
            openjd run "$here/frames.openjd.yaml" --step Frames -p "Project=$project" -p "Frames=$frames" -p "FramesATask=$chunk" \
                -p "Output=$work/$name/f.####.exr" -p "Program=$FOCUS_BRUSH" -p "Arguments=$moving" >"$work/$name.log" 2>&1 && break
        done
        same frames "$name"
    done
else
    echo "SKIPPED openjd: not installed (pip install openjd-cli)"
fi

if command -v slurmctld >/dev/null && command -v munged >/dev/null && [ "$(id -u)" = 0 ]; then
    slurm="$work/slurm"
    if "$here/slurm_on_one_machine.sh" start "$slurm"; then
        export SLURM_CONF="$slurm/slurm.conf"
        for shares in 1 2 7 64; do
            seconds=$of_frames name=slurm-$shares
            begin "$name" "$shares" "$pictures"
            submit "$name" "$shares" frames.sbatch "$frames" "$work/$name/f.####.exr" $moving
            same frames "$name"
            seconds=$of_tiles name=slurm-tiles-$shares
            begin "$name" "$shares" 16
            submit "$name" "$shares" tiles.sbatch 4x4 "$work/$name/big.exr" $still
            merge "$name"
            same tiles "$name"
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
