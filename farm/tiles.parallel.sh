#!/bin/sh
# One picture of a Focus Brush project in tiles by GNU parallel: on this machine, or on several (parallel --sshlogin …, with a shared folder).
#
#   farm/tiles.parallel.sh 8 shot.fbrush 4x4 big.exr --size 8192x4608
#
# Once all are done, the parts are merged: focus-brush merge -o big.exr big.tile*.part
# PARALLEL_OPTIONS go to parallel, as in PARALLEL_OPTIONS='--jobs 2 --retries 3'.
shares=$1 project=$2 tiles=$3 output=$4
shift 4
seq "$shares" | parallel --halt never ${PARALLEL_OPTIONS:---jobs 2} -N1 \
    "${FOCUS_BRUSH:-focus-brush}" render "$project" --tiles "$tiles" -o "$output" --shard '{}/'"$shares" "$@"
