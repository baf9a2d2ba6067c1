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
root=$(cd "$(dirname "$0")/../.." && pwd)
scene=${1:-$root/assets/demo/demo.glb}
out=${2:-$root/target/window}
size=${3:-1600x900}
program=${FOCUS_BRUSH:-$root/target/debug/focus-brush}
width=${size%x*}
height=${size#*x}
patience=${PATIENCE:-300}
# A progress bar has more pixels of its colour than text has by chance.
bar_pixels=250
work=$(mktemp -d)
mkdir -p "$out"
cp "$scene" "$work/"
scene=$work/$(basename "$scene")
project=${scene%.*}.fbrush
server=
app=

finish() {
    [ -n "$app" ] && kill "$app" 2>/dev/null
    [ -n "$server" ] && kill "$server" 2>/dev/null
    rm -rf "$work"
}
trap finish EXIT

fail() {
    import -window root "$out/failed.png" 2>/dev/null
    echo "FAILED: $1 (see $out/failed.png)" >&2
    cat "$work/app.log" >&2
    exit 1
}

# A display of its own, and nothing of the user's: no settings, no session bus (the paths are then typed).
export HOME=$work/home
mkdir -p "$HOME"
unset DBUS_SESSION_BUS_ADDRESS XDG_DATA_HOME WAYLAND_DISPLAY
exec 3> >(cat > "$work/display")
Xvfb -displayfd 3 -screen 0 "${size}x24" >/dev/null 2>&1 &
server=$!
exec 3>&-
for _ in $(seq 50); do [ -s "$work/display" ] && break; sleep 0.1; done
[ -s "$work/display" ] || { echo "FAILED: Xvfb does not start" >&2; exit 1; }
DISPLAY=:$(cat "$work/display")
export DISPLAY

start_app() {
    "$program" "$1" >"$work/app.log" 2>&1 &
    app=$!
    local window=
    for _ in $(seq 200); do
        kill -0 "$app" 2>/dev/null || fail "the program ended at once"
        window=$(xdotool search --name "Focus Brush" 2>/dev/null | tail -1)
        [ -n "$window" ] && break
        sleep 0.1
    done
    [ -n "$window" ] || fail "no window"
    sleep 1
    xdotool windowmove "$window" 0 0 windowsize "$window" "$width" "$height"
    sleep 0.5
    xdotool windowfocus "$window"
    away
}

# The pointer where it hovers nothing.
away() { xdotool mousemove $((width - 5)) $((height - 5)); sleep 0.3; }

# Screenshots of the whole, and of the parts that are compared: the two views without their headers.
shot() { away; import -window root "$out/$1.png"; }
views=$((width - 320))x$((height - 200))+0+110
crop() { convert "$1" -crop "$views" +repage "$2"; }

# How many pixels of the views differ between two screenshots.
differ() {
    crop "$out/$1.png" "$work/a.png"
    crop "$out/$2.png" "$work/b.png"
    compare -metric AE "$work/a.png" "$work/b.png" null: 2>&1 | cut -d' ' -f1
}

# Waits until no progress bar stands in the status line and the views stand still.
settle() {
    local end=$((SECONDS + patience)) still=0
    away
    rm -f "$work/old.png"
    while [ "$still" -lt 3 ]; do
        [ "$SECONDS" -lt "$end" ] || fail "$1: it never comes to rest"
        kill -0 "$app" 2>/dev/null || fail "$1: the program ended"
        import -window root "$work/new.png"
        bar=$(convert "$work/new.png" -crop "x24+0+$((height - 24))" +repage -format %c histogram:info: |
            awk '/#606060/ { n += $1 } END { print n + 0 }')
        if [ "$bar" -lt "$bar_pixels" ] && [ -f "$work/old.png" ] && [ "$(compare -metric AE "$work/old.png" "$work/new.png" null: 2>&1 | cut -d' ' -f1)" = 0 ]; then
            still=$((still + 1))
        else
            still=0
        fi
        mv "$work/new.png" "$work/old.png"
        sleep 0.7
    done
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

# The middles of the two views: what the layout makes of the room beside the inspector.
room=$((width - 300))
middle=$((height / 2 + 10))
paint_x=$((room * 23 / 100))
picture_x=$((room * 73 / 100))

start_app "$scene"
settle "opening"
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
