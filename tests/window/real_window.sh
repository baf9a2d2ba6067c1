#!/bin/bash
# Acts on the real window under Xvfb, by mouse and keys: opens a scene, paints a stroke in both views, sees the picture
# change, undoes, saves, closes, reopens and sees the same. Leaves a screenshot of every step.
#
#   tests/window/real_window.sh [SCENE] [FOLDER] [WIDTHxHEIGHT]
#
# SCENE    a glTF scene (default: the demo's)
# FOLDER   where the screenshots go (default: target/window)
# Needs a built focus-brush (FOCUS_BRUSH=… if it is not in target/debug), xvfb, xdotool and imagemagick.
set -u
# Light is refined for minutes before the window comes to rest.
PATIENCE=${PATIENCE:-900}
root=$(cd "$(dirname "$0")/../.." && pwd)
scene=${1:-$root/assets/demo/demo.glb}
out=${2:-$root/target/window}
size=${3:-1600x900}
. "$root/tests/window/display.sh"
cp "$scene" "$work/"
scene=$work/$(basename "$scene")
project=${scene%.*}.fbrush

# The parts of screenshots that are compared: the two views without their headers.
views=$((width - 320))x$((height - 200))+0+110
crop() { convert "$1" -crop "$views" +repage "$2"; }

# How many pixels of the views differ between two screenshots.
differ() {
    crop "$out/$1.png" "$work/a.png"
    crop "$out/$2.png" "$work/b.png"
    compare -metric AE "$work/a.png" "$work/b.png" null: 2>&1 | cut -d' ' -f1
}

# A stroke along the line between two positions of the screen.
stroke() {
    xdotool mousemove "$1" "$2" sleep 0.2 mousedown 1 sleep 0.1
    for k in $(seq 1 12); do
        xdotool mousemove $(($1 + ($3 - $1) * k / 12)) $(($2 + ($4 - $2) * k / 12)) sleep 0.04
    done
    xdotool mouseup 1
}

expect_change() { [ "$(differ "$1" "$2")" -gt 200 ] || fail "$3"; echo "ok: $4"; }
expect_same() {
    local pixels
    pixels=$(differ "$1" "$2")
    [ "$pixels" = 0 ] || fail "$3 ($pixels pixels differ)"
    echo "ok: $4"
}

# The middles of the two views, side by side: what the layout makes of the room between tools and inspector.
tools=44
room=$((width - 300 - tools))
middle=$((height / 2 + 10))
paint_x=$((tools + room * 23 / 100))
picture_x=$((tools + room * 73 / 100))

start_app "$scene"
settle "opening"
xdotool key ctrl+alt+2
settle "the views side by side"
shot 1-opened
echo "ok: opened $(basename "$scene")"

for _ in $(seq 9); do xdotool key period; sleep 0.05; done
stroke $((paint_x - 50)) $((middle + 10)) $((paint_x + 50)) $((middle + 30))
settle "painting in the paint view"
shot 2-painted-in-3d
expect_change 1-opened 2-painted-in-3d "a stroke in the paint view changes nothing" "a stroke in the paint view shows"

stroke $((picture_x - 60)) $((middle + 40)) $((picture_x + 40)) $((middle + 20))
settle "painting in the picture"
shot 3-painted-in-picture
expect_change 2-painted-in-3d 3-painted-in-picture "a stroke in the picture changes nothing" "a stroke in the picture shows"

xdotool key ctrl+z
settle "undo"
shot 4-undone
expect_same 2-painted-in-3d 4-undone "undo does not bring the old picture back" "undo brings the old picture back"

xdotool key ctrl+s
sleep 1
import -window root "$out/5-save-dialog.png"
xdotool key Return
settle "saving"
[ -s "$project" ] || fail "no project was saved"
echo "ok: saved $(basename "$project"), $(stat -c %s "$project") bytes"

xdotool key ctrl+q
for _ in $(seq 100); do kill -0 "$app" 2>/dev/null || break; sleep 0.1; done
kill -0 "$app" 2>/dev/null && fail "it does not close after saving"
app=
echo "ok: closed without a question"

start_app "$project"
settle "reopening"
shot 6-reopened
expect_same 4-undone 6-reopened "reopened it looks different" "reopened it looks the same"
echo "all is well; screenshots in $out"
