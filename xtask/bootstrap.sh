#!/bin/sh
# Runs a chore (`cargo xtask`) on a machine that may have nothing but Rust and apt: Rust itself cannot link without
# a C compiler, so that one is installed here; the chore installs the rest.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
command -v cargo >/dev/null 2>&1 || PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
if ! command -v cargo >/dev/null 2>&1; then
    echo "error: cargo: not found (install Rust: https://rustup.rs)" >&2
    exit 1
fi

if ! command -v cc >/dev/null 2>&1; then
    by_hand="sudo apt-get install --no-install-recommends gcc libc6-dev"
    missing() {
        echo "error: there is no C compiler to link with (install one: $by_hand)" >&2
        exit 1
    }
    command -v apt-get >/dev/null 2>&1 || missing
    person=no
    if [ -z "${CI:-}" ] && [ -t 0 ] && [ -t 2 ]; then person=yes; fi
    if [ "$(id -u)" = 0 ]; then
        as_root=""
    elif [ $person = yes ] && command -v sudo >/dev/null 2>&1; then
        as_root="sudo"
    elif sudo -n true >/dev/null 2>&1; then
        as_root="sudo -n"
    else
        missing
    fi
    if [ $person = yes ]; then
        printf 'Missing packages: gcc libc6-dev\nInstall them with apt-get now? [Y/n] ' >&2
        read -r answer || missing
        case $answer in "" | y | Y | yes | Yes) ;; *) missing ;; esac
    fi
    # shellcheck disable=SC2086 # as_root is zero, one or two words
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q update >&2 || true
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends gcc libc6-dev \
        </dev/null >&2 || missing
fi

exec cargo run --quiet --manifest-path "$root/Cargo.toml" --package xtask -- "$@"
