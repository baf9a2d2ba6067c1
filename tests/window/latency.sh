#!/bin/bash
# How soon paint is seen: plays recorded strokes on the demo in the real window under Xvfb, and prints the program's own trace.
#
#   tests/window/latency.sh [WIDTHxHEIGHT] [FILE]
#
# WIDTHxHEIGHT  of the picture (default: 1920x1080; its light field takes minutes)
# FILE          where the trace goes (default: target/window/latency.json)
# CACHE=FOLDER keeps the light field there: the next run of the same build opens without baking it.
# See display.sh for what it needs. Leave the machine alone meanwhile.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
picture=${1:-1920x1080}
trace=${2:-$root/target/window/latency.json}
out=$(dirname "$trace")
size=1440x860
. "$root/tests/window/display.sh"
cp "$root/assets/demo/demo.glb" "$work/"
sed -e "s/\"width\": [0-9]*/\"width\": ${picture%x*}/" -e "s/\"height\": [0-9]*/\"height\": ${picture#*x}/" \
    "$root/assets/demo/demo.camera.json" > "$work/camera.json"
"$program" new "$work/demo.glb" --camera "$work/camera.json" --focus "$root/assets/demo/demo.focus.json" \
    -o "$work/demo.fbrush" 2>/dev/null || fail "no project"
start_app "$work/demo.fbrush" --replay "$root/tests/window/latency.json" --trace "$trace" --preview-size "${picture%x*}"
wait "$app"
app=
[ -s "$trace" ] || fail "no trace was written"
cat "$trace"
