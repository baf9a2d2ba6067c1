#!/bin/bash
# Paints the demo from nothing to a finished picture, by playing a recording in the real window under Xvfb, and looks at every
# panel. Leaves a screenshot of every step, to be looked at critically.
#
#   tests/window/painting.sh [FOLDER] [WIDTHxHEIGHT]
#
# FOLDER   where the screenshots go (default: target/window/painting)
# SCALE=2 makes everything twice as large: with 2560x1440 the window is laid out as with 1280x720.
# See display.sh for what it needs.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
out=${1:-$root/target/window/painting}
size=${2:-1280x720}
. "$root/tests/window/display.sh"
project=$work/garden.fbrush
cp "$root/assets/demo/demo.glb" "$work/"
"$program" new "$work/demo.glb" --camera "$root/assets/demo/demo.camera.json" -o "$project" || fail "no project"

# Tenths of a second: four times the pixels take four times as long to draw without a graphics card.
pause() { sleep "$(($1 * scale * scale / 10)).$(($1 * scale * scale % 10))"; }
at() { xdotool mousemove $(($1 * scale)) $(($2 * scale)); pause 3; }
click() { at "$1" "$2"; xdotool click 1; pause 4; }
key() { xdotool key "$1"; pause 6; }
palette() { key ctrl+shift+p; xdotool type --delay 40 "$1"; pause 6; key Return; }
# Points of the window as the layout has it at 1280 × 720 points.
wide=$((width / scale))
high=$((height / scale))
inspector=$((wide - 150))

start_app "$project"
settle "opening"
shot 01-nothing
xdotool key ctrl+q
wait "$app" 2>/dev/null

# Every stroke of the recording waits for the picture of the one before.
start_app "$project" --replay "$root/tests/window/painting.json"
for k in $(seq 1 400); do
    kill -0 "$app" 2>/dev/null || fail "painting: the program ended"
    # A star is in the title once anything is painted.
    title=$(xdotool search --name "Focus Brush" getwindowname 2>/dev/null | tail -1)
    case $title in *"*"*) import -window root "$out/02-painting-$(printf %02d "$k").png" ;; esac
    [ "$(ls "$out" | grep -c '^02-painting')" -ge "${SERIES:-10}" ] && break
    sleep 1
done
settle "painting"
shot 03-finished

key F7
settle "the atlas"
shot 10-atlas
key F8 # which also chooses the tool to look with
click $((wide * 60 / 100)) $((high * 40 / 100))
shot 11-aperture
key F9
settle "the histogram"
shot 12-histogram
key F9
at "$inspector" $((high / 2))
xdotool click --repeat 8 --delay 60 5
pause 9
import -window root "$out/13-inspector-middle.png"
xdotool click --repeat 60 --delay 20 5
pause 9
import -window root "$out/14-inspector-end.png"
xdotool click --repeat 90 --delay 20 4
key w
settle "comparing"
shot 15-compared
key w
key ctrl+shift+p
shot 16-palette
key Escape
key F1
shot 17-help
key F1
# Once one is open, the others open under the pointer: a click would close them.
click 19 12
for menu in file:19 edit:51 select:90 view:131 focus:173 layer:215 lens:254 render:299 help:343; do
    at "${menu#*:}" 12
    pause 8
    import -window root "$out/18-menu-${menu%:*}.png"
done
key Escape
away
palette "light"
settle "the light theme"
shot 19-light-theme
palette "light"
key ctrl+shift+s
shot 20-save-as
key Escape
echo "all is well; screenshots in $out"
