#!/bin/sh
# Frames of a Focus Brush project by GNU parallel: on this machine, or on several (parallel --sshlogin …, with a shared folder).
#
#   farm/frames.parallel.sh 8 shot.fbrush 1-240 'out.####.exr' --fps 25
#
# PARALLEL_OPTIONS go to parallel, as in PARALLEL_OPTIONS='--jobs 2 --retries 3'.
shares=$1 project=$2 frames=$3 output=$4
shift 4
export FOCUS_BRUSH_SHARDS="$shares"
seq "$shares" | parallel --env FOCUS_BRUSH_SHARDS --halt never ${PARALLEL_OPTIONS:---jobs 2} -N1 \
    "${FOCUS_BRUSH:-focus-brush}" render "$project" --frames "$frames" -o "$output" --shard '{}/'"$shares" "$@"
