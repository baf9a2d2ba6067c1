#!/bin/bash
# What an artist does first with a file of their own, in the real window under Xvfb, by mouse and keys: opens it, keeps three cameras
# while orbiting in the picture, paints in it, and exports it. One picture shows every scene as it opens, as it is painted, and as it is exported.
#
#   tests/window/own_scenes.sh FOLDER SCENE…
#
# FOLDER   where the screenshots and all.jpg go
# SCENE    glTF scenes; folders with other files of a scene are used where they are
# Needs a built focus-brush (FOCUS_BRUSH=… if it is not in target/debug), xvfb, xdotool and imagemagick.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
out=$1
shift
size=1280x720
. "$root/tests/window/display.sh"

# The middle of the picture, which fills what tools and inspector leave.
x=$(((width - 300 + 44) / 2))
y=$((height / 2))

# A drag with a button, by so many pixels.
drag() {
    xdotool mousemove "$2" "$3" sleep 0.2 mousedown "$1" sleep 0.1
    for _ in $(seq 15); do xdotool mousemove_relative -- "$4" "$5" sleep 0.04; done
    xdotool mouseup "$1" sleep 0.3
}

# A camera is kept after every turn.
bookmark() {
    away
    xdotool key ctrl+alt+b
    sleep 0.5
}

# How long the picture has to get better after each step, s: it is blurred long before it is exact.
rest=${REST:-40}

rows=()
for scene in "$@"; do
    name=$(basename "${scene%.*}")
    start_app "$scene"
    sleep "$rest"
    shot "$name-1-opened"
    bookmark
    drag 2 "$x" "$y" 4 1
    bookmark
    drag 2 "$x" "$y" -8 -1
    bookmark
    sleep "$rest"
    shot "$name-2-turned"
    # Sharp, across the middle.
    drag 1 $((x - 60)) $((y + 15)) 8 1
    sleep "$rest"
    shot "$name-3-painted"
    # The paint view, over the lower left corner, stands still but for paint.
    for step in 2-turned 3-painted; do
        convert "$out/$name-$step.png" -crop "250x130+70+540" +repage "$work/$step-paint.png"
    done
    changed=$(compare -metric AE "$work/2-turned-paint.png" "$work/3-painted-paint.png" null: 2>&1 | cut -d' ' -f1)
    [ "$changed" -gt 20 ] || fail "$name: a stroke in the picture paints nothing"
    rm -f "$work/export.png"
    xdotool key ctrl+e
    sleep 3
    import -window root "$out/$name-export-dialog.png"
    xdotool key Return
    sleep 3
    xdotool key ctrl+a
    xdotool type "$work/export.png"
    sleep 1
    xdotool key Return
    for _ in $(seq "$patience"); do [ -s "$work/export.png" ] && break; sleep 1; done
    [ -s "$work/export.png" ] || fail "$name: no picture was exported"
    sleep 1
    cp "$work/export.png" "$out/$name-4-exported.png"
    kill "$app"
    wait "$app" 2>/dev/null
    app=
    for step in 1-opened 3-painted 4-exported; do
        convert "$out/$name-$step.png" -resize 640x360 -background '#303030' -gravity center -extent 640x360 "$work/$step.png"
    done
    convert "$work/1-opened.png" "$work/3-painted.png" "$work/4-exported.png" +append "$out/$name-row.png"
    rows+=("$out/$name-row.png")
    echo "ok: $name"
done
convert "${rows[@]}" -append -quality 85 "$out/all.jpg"
echo "all is well; screenshots in $out"
