#!/bin/sh
# Renders the pictures of presets/README.md: one frame of each shot.
#
#   presets/make_gallery.sh build/tool/softreel [SAMPLES [SHOT ...]]
set -eu

if [ $# -lt 1 ]; then
  echo "usage: $0 SOFTREEL [SAMPLES [SHOT ...]]" >&2
  exit 2
fi
program=$1
samples=${2:-64}
shift
[ $# -eq 0 ] || shift
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The frame of each shot that says most.
frames="first_pull=38 bar_twist=64 soft_knees=37 two_bodies=14 pudding=17 small_strain=32 stiffness=10 long_stretch=42
  flutter=60 stress=26 daylight=21 puppet=20 cushion=24 material_board=1 jelly_hat=30"

mkdir -p "$here/gallery"
for entry in $frames; do
  shot=${entry%=*} frame=${entry#*=}
  case " $* " in *" $shot "* | "  ") ;; *) continue ;; esac
  "$program" render "$here/$shot.toml" --quiet --frames "$frame" --output "$work" --cache "$work/cache" \
    --set render.width=480 --set render.height=270 --set "render.samples=$samples" --set output.movie=false
  mv "$work/$shot.$(printf %04d "$frame").png" "$here/gallery/$shot.png"
done
