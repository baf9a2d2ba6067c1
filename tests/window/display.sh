# What the scripts of this folder share: a display of its own with the program on it, screenshots, waiting. To be sourced, with
# `root` (of the repository), `out` (where screenshots go) and `size` (of the display, WIDTHxHEIGHT in px) set.
# SCALE=2 makes everything twice as large. Needs a built focus-brush (FOCUS_BRUSH=… if it is not in target/debug), xvfb,
# xdotool and imagemagick.
program=${FOCUS_BRUSH:-$root/target/debug/focus-brush}
width=${size%x*}
height=${size#*x}
scale=${SCALE:-1}
patience=${PATIENCE:-300}
# A progress bar has more pixels of the colour behind it than text has by chance.
bar_pixels=250
work=$(mktemp -d)
mkdir -p "$out"
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
export XDG_CACHE_HOME=${CACHE:-$work/home/.cache}
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
for _ in $(seq 100); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done

# Starts the program with these arguments, its window over the whole display.
start_app() {
    WINIT_X11_SCALE_FACTOR=$scale "$program" "$@" >"$work/app.log" 2>&1 &
    app=$!
    local window=
    for _ in $(seq 200); do
        kill -0 "$app" 2>/dev/null || fail "the program ended at once"
        window=$(xdotool search --onlyvisible --name "Focus Brush" 2>/dev/null | tail -1)
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

# A screenshot of the whole.
shot() { away; import -window root "$out/$1.png"; }

# Waits until no progress bar stands in the status line and the views stand still.
settle() {
    local end=$((SECONDS + patience)) still=0
    away
    rm -f "$work/old.png"
    while [ "$still" -lt 3 ]; do
        [ "$SECONDS" -lt "$end" ] || fail "$1: it never comes to rest"
        kill -0 "$app" 2>/dev/null || fail "$1: the program ended"
        import -window root "$work/new.png"
        bar=$(convert "$work/new.png" -crop "x$((24 * scale))+0+$((height - 24 * scale))" +repage -format %c histogram:info: |
            awk '/#181818/ { n += $1 } END { print n + 0 }')
        if [ "$bar" -lt "$bar_pixels" ] && [ -f "$work/old.png" ] && [ "$(compare -metric AE "$work/old.png" "$work/new.png" null: 2>&1 | cut -d' ' -f1)" = 0 ]; then
            still=$((still + 1))
        else
            still=0
        fi
        mv "$work/new.png" "$work/old.png"
        sleep 0.7
    done
}
