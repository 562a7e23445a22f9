#!/bin/sh
# Renders three moments of the default shot and joins them to the picture of README.md.
#
#   assets/make_readme_picture.sh build/tool/softreel [SAMPLES]
set -eu

if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  echo "usage: $0 SOFTREEL [SAMPLES]" >&2
  exit 2
fi
program=$1
samples=${2:-64}
frames="1 40 46"  # at rest, at full stretch, just after it is let go

here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

inputs=
for frame in $frames; do
  "$program" render "$here/../presets/first_pull.toml" --quiet --frames "$frame" --output "$work" \
    --set render.width=400 --set render.height=500 --set "render.samples=$samples" --set output.movie=false
  inputs="$inputs -i $work/first_pull.$(printf %04d "$frame").png"
done

# shellcheck disable=SC2086  # one word for each argument
ffmpeg -v error -y $inputs -filter_complex "hstack=inputs=3" -frames:v 1 -compression_level 9 "$here/first_pull.png"
ls -l "$here/first_pull.png"
