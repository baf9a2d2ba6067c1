#!/bin/bash
# Tries packages where there is nothing but Debian: in_chroot.sh FOLDER [deb|tarball|source…]
#
# FOLDER holds what `cargo xtask package` made. For each kind a bare Debian is made (debootstrap), the package put into it, `doctor` asked and
# the demo rendered. The source archive is built there without a network, with the Rust toolchain of this machine. Needs root and debootstrap.
set -euo pipefail

packages=$(cd "$1" && pwd)
shift
kinds=${*:-deb tarball source}
suite=${SUITE:-bookworm}
mirror=${MIRROR:-http://deb.debian.org/debian}
place=${PLACE:-$(mktemp -d)}
base=$place/base
mkdir -p "$place"

[ -d "$base/usr" ] || debootstrap --variant=minbase "$suite" "$base" "$mirror" >"$place/debootstrap.log"

# A fresh copy of it.
bare() {
    rm -rf "${place:?}/$1"
    cp -a "$base" "$place/$1"
    cp /etc/resolv.conf "$place/$1/etc/resolv.conf"
}

within() {
    local root=$place/$1
    shift
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}

# Asks the program what is missing, and has it render the demo.
tried() {
    local kind=$1 program=$2 demo=$3
    # 5: no graphics card, which is right here.
    within "$kind" "$program" doctor || [ $? = 5 ]
    within "$kind" "$program" render "$demo" --size 480x270 -o /tmp/demo.png
    within "$kind" test -s /tmp/demo.png
    cp "$place/$kind/tmp/demo.png" "$place/$kind.png"
    echo "$kind: rendered the demo: $place/$kind.png"
}

for kind in $kinds; do
    bare "$kind"
    case $kind in
    deb)
        cp "$packages"/focus-brush_*.deb "$place/deb/tmp/"
        within deb apt-get -q update
        within deb sh -c 'apt-get -q install -y --no-install-recommends /tmp/focus-brush_*.deb'
        within deb test -s /usr/share/applications/focus-brush.desktop
        tried deb focus-brush /usr/share/focus-brush/demo/demo.fbrush
        within deb apt-get -q remove -y focus-brush
        within deb sh -c 'test ! -e /usr/share/focus-brush && test ! -e /usr/bin/focus-brush'
        ;;
    tarball)
        mkdir -p "$place/tarball/opt"
        tar -xf "$packages"/focus-brush-*-linux-*.tar.xz -C "$place/tarball/opt"
        folder=$(basename "$place"/tarball/opt/focus-brush-*)
        # The C++ library is on every desktop, and not in a bare chroot.
        within tarball sh -c 'apt-get -q update && apt-get -q install -y --no-install-recommends libstdc++6'
        tried tarball "/opt/$folder/bin/focus-brush" "/opt/$folder/share/focus-brush/demo/demo.fbrush"
        ;;
    source)
        tar -xf "$packages"/focus-brush-*-source.tar.xz -C "$place/source/opt"
        folder=$(basename "$place"/source/opt/focus-brush-*)
        within source sh -c 'apt-get -q update && apt-get -q install -y --no-install-recommends gcc g++ libclang-dev libc6-dev'
        mkdir -p "$place/source/rust"
        cp -a "$(rustc --print sysroot)/." "$place/source/rust/"
        # No network: a namespace without any. The compiler finds its libraries by /proc.
        unshare --net --mount sh -c 'mount -t proc proc "$1/proc" && shift && exec chroot "$@"' sh \
            "$place/source" "$place/source" /usr/bin/env -i PATH=/rust/bin:/usr/bin:/bin HOME=/root LANG=C.UTF-8 \
            CARGO_BUILD_JOBS="${JOBS:-$(nproc)}" sh -c "cd /opt/$folder && cargo build --release -p focus-brush"
        tried source "/opt/$folder/target/release/focus-brush" "/opt/$folder/assets/demo/demo.fbrush"
        ;;
    *)
        echo "error: $kind: no package (there are deb, tarball, source)" >&2
        exit 2
        ;;
    esac
done
