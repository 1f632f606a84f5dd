#!/bin/sh
# Packages the core as it would be published, unpacks it elsewhere, and builds this firmware on it: tests on the host,
# then a build for a Cortex-M4F. Needs `rustup target add thumbv7em-none-eabihf`, or pass another target.
#
#   examples/other-firmware/build.sh [TARGET]
set -eu
target="${1:-thumbv7em-none-eabihf}"
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../.." && pwd)"
work="$here/target/packaged"

cd "$root"
cargo package --package shakedown-core --allow-dirty --no-verify --quiet
version="$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"$/\1/p' Cargo.toml)"
crate="${CARGO_TARGET_DIR:-$root/target}/package/shakedown-core-$version.crate"
rm -rf "$work"
mkdir -p "$work"
tar -xzf "$crate" -C "$work"

cd "$here"
patch="patch.crates-io.shakedown-core.path=\"$work/shakedown-core-$version\""
cargo test --quiet --config "$patch"
cargo build --quiet --release --target "$target" --config "$patch"
echo "built on shakedown-core $version as packaged: host (tests passed) and $target"
