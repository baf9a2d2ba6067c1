#!/bin/bash
# Renders the book's pictures of the demo again: docs/pictures/*/*.jpg, and the drawings docs/pictures/model/*.svg.
#
#   docs/pictures/make.sh [FOCUS-BRUSH] [FOLDER]
#
# FOCUS-BRUSH is the program (default: the one on the path). What is in between goes to FOLDER and is kept: a light field that is
# there is not baked again (default: a temporary folder). Needs ImageMagick and Python. All is drawn from assets/demo and from
# what stands beside this script; a light field is baked once and serves all pictures. Cycles' picture in comparing/cycles.jpg comes from
# bridges/compare/render_cycles.py, which needs bpy: it is made if PYTHON_WITH_BPY names a Python that has it, else left as it is.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
program=${1:-focus-brush}
here=$root/docs/pictures
demo=$root/assets/demo
if [ -n "${2:-}" ]; then
    mkdir -p "$2"
    cd "$2"
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    cd "$work"
fi
# Pictures in rows, with captions of so many pixels, which can be read on a narrow screen, too: `sheet 28 -tile 2x2 …`.
sheet() { montage -font DejaVu-Sans -pointsize "$1" -fill '#222' -background white -geometry '+4+4' "${@:2}"; }

python3 "$here/model/figures.py" "$here/model"

ln -sf "$demo/demo.glb" demo.glb
[ -e demo.salf ] || "$program" bake demo.glb --camera "$demo/demo.camera.json" --size 640x360 -o demo.salf
draw() { "$program" render demo.salf "$@"; }
# The demo's camera with other values, as `camera focus_distance 0.4 OUT.json`.
camera() { python3 -c 'import json,sys
camera = json.load(open(sys.argv[1])) | {"width": 640, "height": 360, sys.argv[2]: json.loads(sys.argv[3])}
json.dump(camera, open(sys.argv[4], "w"))' \
    "$demo/demo.camera.json" "$1" "$2" "$3"; }

# What the anchor does: the tower is made sharp in either way, then the lens is focused elsewhere.
camera focus_distance 0.42 near.json
for anchor in point lens; do
    draw --focus "$here/painting/tower-by-$anchor.focus.json" -o "$anchor-fox.png"
    draw --camera near.json --focus "$here/painting/tower-by-$anchor.focus.json" -o "$anchor-near.png"
done
sheet 26 -tile 2x2 \
    -label 'by point, lens focused on the fox' point-fox.png -label 'by lens, lens focused on the fox' lens-fox.png \
    -label 'by point, lens focused nearer' point-near.png -label 'by lens, lens focused nearer' lens-near.png \
    -quality 88 "$here/painting/anchor.jpg"

# The same lens, closed.
stops=()
for stop in "f/9.4 0.0025" "f/4.7 0.005" "f/2.3 0.01" "f/1.1 0.0205"; do
    set -- $stop
    draw --aperture-radius "$2" -o "stop-$2.png"
    stops+=(-label "$1" "stop-$2.png")
done
sheet 26 -tile 2x2 "${stops[@]}" -quality 88 "$here/lens-and-bokeh/stops.jpg"

# Shapes: the lights at the upper left, and one of them in near blur.
lights=260x200+380+20
labels=()
for shape in "Round" "Hexagon" "Star" "Heart" "Ring (mirror lens)" "Anamorphic 2:1"; do
    draw --bokeh "$shape" -o whole.png
    convert whole.png -crop "$lights" +repage "shape-${#labels[@]}.png"
    labels+=(-label "$shape" "shape-${#labels[@]}.png")
done
sheet 20 -tile 3x2 "${labels[@]}" -quality 88 "$here/lens-and-bokeh/bokeh.jpg"

draw --bokeh Heart -o whole.png
convert whole.png -crop "$lights" +repage far.png
draw --bokeh Heart --focus "$here/lens-and-bokeh/lights-in-near-blur.focus.json" -o whole.png
convert whole.png -crop "$lights" +repage turned.png
sheet 16 -tile 2x1 -label 'far blur' far.png -label 'painted near' turned.png -quality 88 "$here/lens-and-bokeh/near-and-far.jpg"

# Six lenses with a character: small lamps behind and before the focus, and the demo.
for subject in lamps demo; do
    sheets=()
    while IFS='|' read -r name focal_length f_number; do
        picture="$subject-$focal_length.png"
        if [ $subject = lamps ]; then
            python3 "$here/lens-and-bokeh/lamps.py" "$focal_length" "$f_number" lamps.glb lamps.json
            "$program" render lamps.glb --camera lamps.json --lens "$name" -o "$picture"
        else
            "$program" render demo.glb --camera "$demo/demo.camera.json" --size 640x360 --lens "$name" -o "$picture"
        fi
        sheets+=(-label "$name" "$picture")
    done <<'LENSES'
Swirling portrait lens 58 mm f/2|0.058|2
Soap-bubble triplet 100 mm f/2.8|0.1|2.8
Soft-rimmed portrait lens 135 mm f/2.8|0.135|2.8
Early ultra-fast 50 mm f/0.95|0.05|0.95
Curved-field projection lens 85 mm f/2.2|0.085|2.2
Wide angle 24 mm f/1.4 with falloff|0.024|1.4
LENSES
    sheet 26 -tile 2x3 "${sheets[@]}" -quality 88 "$here/lens-and-bokeh/character-$subject.jpg"
done

# Beside Cycles, and how far two pictures of Cycles are from each other.
if [ -n "${PYTHON_WITH_BPY:-}" ]; then
    for seed in 0 1; do
        [ -e "cycles-$seed.exr" ] || "$PYTHON_WITH_BPY" "$root/bridges/compare/render_cycles.py" demo.glb "$demo/demo.camera.json" \
            "cycles-$seed.exr" --size 480x270 --spp 512 --seed "$seed"
    done
    [ -e ours.exr ] || "$program" render demo.glb --camera "$demo/demo.camera.json" --size 480x270 --back-faces show --tolerance 0 -o ours.exr
    echo "ours, Cycles" && "$program" compare ours.exr cycles-0.exr --error-map map.png
    echo "Cycles, Cycles of another seed" && "$program" compare cycles-1.exr cycles-0.exr
    for picture in ours cycles-0; do convert "$picture.exr" -colorspace sRGB "$picture.png"; done
    sheet 30 -tile 3x1 -label 'Focus Brush' ours.png -label 'Cycles' cycles-0.png -label 'FLIP' map.png -quality 88 \
        "$here/comparing/cycles.jpg"
fi
